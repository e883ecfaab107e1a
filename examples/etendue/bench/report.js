// The page: what was measured and how, curves and tables, threads, images.

function facts() {
  const machine = RESULTS.machine, list = make("dl", { class: "facts" });
  const fact = (name, ...value) => list.append(make("dt", {}, name), make("dd", {}, ...value));
  if (machine) {
    fact("Machine", `${machine.cpu}, ${machine.logicalCores} logical cores, ${machine.os}`);
    fact("Renderer", `${machine.renderer}, Embree ${machine.embree}, ${machine.build}`);
  }
  fact("Measured", `${RESULTS.when || "–"}; ${RESULTS.runs} runs of each case with different seeds, in turns`);
  if (RESULTS.command.length) fact("Command", make("code", {}, RESULTS.command.map((word) => (/[^\w.,:/=-]/.test(word) ? `'${word.replaceAll("'", "'\\''")}'` : word)).join(" ")));
  fact("Error", "relative mean squared error: mean over pixels and channels of (x − r)² / (r² + e) against the reference r, e = 1 % of its squared mean; the reference's own noise is taken off. Noise is the share that differs from run to run, bias² the share that all runs have in common.");
  fact("Time", "rendering alone, photon maps included; without reading and building the scene. Medians; bars and brackets are least and most.");
  return list;
}

function between(spread, number = digits) {
  if (!spread) return "–";
  if (spread.min === spread.max) return number(spread.median);
  return [number(spread.median), " ", make("small", {}, `(${number(spread.min)}–${number(spread.max)})`)];
}

function bias(point) {
  if (point.bias === null || point.bias === undefined) return "–";
  return point.bias > point.biasResolution ? digits(point.bias) : `< ${digits(point.biasResolution)}`;
}

function table(plot) {
  const rows = plot.series.flatMap(([index, label]) => RESULTS.series[index].points.map((point) => ({ label, point })));
  // What is wrong all the time is not efficient, however soon.
  const isFair = (point) => point.efficiency && !(point.bias > point.biasResolution);
  const best = Math.max(...rows.map(({ point }) => isFair(point) ? point.efficiency.median : 0));
  const heads = ["", "samples", "time (s)", "Mrays/s", "error", "noise", "bias²", "mean / ref.", "1 / (error × s)", "peak MiB"];
  const row = ({ label, point }) => make("tr", { class: isFair(point) && point.efficiency.median === best ? "best" : null },
    [label, point.samples ?? "–", between(point.seconds), point.raysPerSecond ? digits(1e-6 * point.raysPerSecond.median) : "–", between(point.relMse),
      digits(point.noise), bias(point), point.meanRatio ? point.meanRatio.toFixed(4) : "–", between(point.efficiency),
      point.peakMemory ? Math.ceil(point.peakMemory / 2 ** 20) : "–"].map((cell) => make("td", {}, ...[cell].flat())));
  return make("div", { class: "panel scroll", tabindex: 0, role: "region", "aria-label": `Table: ${plot.title}, ${plot.scene}` },
    make("table", {}, make("thead", {}, make("tr", {}, heads.map((head) => make("th", { scope: "col" }, head)))), make("tbody", {}, rows.map(row))));
}

function describe(point) {
  const between = (spread, number) => (spread.min === spread.max ? number(spread.median) : `${number(spread.median)} (${number(spread.min)}–${number(spread.max)})`);
  const lines = [point.samples ? `${point.samples} samples per pixel` : null, `time ${between(point.seconds, seconds)}`, `error ${between(point.relMse, digits)}`,
    point.raysPerSecond ? `${digits(1e-6 * point.raysPerSecond.median)} Mrays/s` : null];
  return lines.filter(Boolean).join("\n");
}

function section(plot, number) {
  const curves = plot.series.map(([index, label]) => ({ label, points: RESULTS.series[index].points.map((point) => ({ x: point.seconds, y: point.relMse, text: describe(point) })) }));
  const name = RESULTS.series[plot.series[0][0]].reference;
  const reference = RESULTS.references.find((reference) => reference.name === name);
  const against = reference ? `Reference: ${reference.name}${reference.samples ? `, ${reference.samples} samples per pixel` : ""}${reference.noise !== null ? `, own noise ${digits(reference.noise)}` : ""}.` : "";
  return make("section", { id: `plot-${number}` }, make("h2", {}, plot.title, " ", make("small", {}, plot.scene)),
    plot.description ? make("p", {}, plot.description) : null, make("p", { class: "soft" }, against),
    logPlot(curves, "time (s)", "relative mean squared error", { slope: -1, name: "error ∝ 1 / time" }), table(plot));
}

/** Rays per second and speed-up by the number of threads, where several were tried. */
function scaling() {
  const panels = [];
  for (const plot of DATA.plots) {
    const families = new Map();
    for (const [index] of plot.series) {
      const series = RESULTS.series[index], point = series.points[series.points.length - 1];
      if (!series.threads || !point.raysPerSecond) continue;
      const label = [series.renderer, series.name].filter(Boolean).join(", ");
      families.set(label, [...(families.get(label) ?? []), { threads: series.threads, rate: point.raysPerSecond }]);
    }
    const curves = [...families].filter(([, points]) => new Set(points.map((point) => point.threads)).size > 1).map(([label, points]) => {
      points.sort((a, b) => a.threads - b.threads);
      const first = points[0];
      return { label, points: points.map(({ threads, rate }) => ({
        x: { median: threads, min: threads, max: threads },
        y: { median: 1e-6 * rate.median, min: 1e-6 * rate.min, max: 1e-6 * rate.max },
        text: `${threads} threads\n${digits(1e-6 * rate.median)} Mrays/s\n${digits(rate.median / first.rate.median)} times as fast as ${first.threads}` })) };
    });
    if (curves.length) panels.push(make("h3", {}, plot.title, " ", make("small", {}, plot.scene)), logPlot(curves, "threads", "Mrays/s", { slope: 1, name: "rays ∝ threads" }, true));
  }
  return panels.length ? make("section", { id: "scaling" }, make("h2", {}, "Scaling"), make("p", { class: "soft" }, "Rays per second with the largest budget, by the number of threads."), panels) : null;
}

(function build() {
  document.title = RESULTS.title || "Étendue benchmark";
  const plots = DATA.plots.filter((plot) => plot.series.length);
  const threads = scaling(), images = viewer();
  const links = plots.map((plot, number) => make("a", { href: `#plot-${number}` }, plot.title === plot.scene ? plot.scene : `${plot.title}: ${plot.scene}`));
  if (threads) links.push(make("a", { href: "#scaling" }, "Scaling"));
  if (images) links.push(make("a", { href: "#images" }, "Images"));
  document.getElementById("head").append(make("h1", {}, document.title), RESULTS.description ? make("p", {}, RESULTS.description) : "", facts(),
    RESULTS.complete ? "" : make("p", { class: "warning" }, "This benchmark was stopped before its end: what was measured until then is shown."), make("nav", { "aria-label": "Contents" }, links));
  const notes = RESULTS.notes.length ? make("section", { id: "notes" }, make("h2", {}, "Notes"), make("ul", {}, RESULTS.notes.map((note) => make("li", {}, note)))) : null;
  document.getElementById("main").replaceChildren(...[...plots.map(section), threads, images, notes].filter(Boolean));
})();
