// Curves of error against time, both logarithmic.

/** Ends of a logarithmic axis around values, with a little room; at least a factor of four. */
function axis(values) {
  const logs = values.filter((value) => value > 0).map(Math.log10);
  let low = Math.min(...logs), high = Math.max(...logs);
  const room = Math.max(0.06 * (high - low), (0.6 - (high - low)) / 2, 0.05);
  return [low - room, high + room];
}

/** Places for marks: powers of ten, and 2 and 5 between them where there are few. */
function ticks([low, high]) {
  const steps = high - low > 4 ? [1] : high - low > 1.2 ? [1, 2, 5] : [1, 1.5, 2, 3, 4, 5, 6, 8];
  const marks = [];
  for (let power = Math.floor(low); power <= Math.ceil(high); power++) {
    for (const step of steps) {
      const log = power + Math.log10(step);
      if (log >= low && log <= high) marks.push({ log, value: step * 10 ** power });
    }
  }
  return marks;
}

/**
 * Log-log curves. `curves`: [{label, points: [{x, y, text}]}], x and y being {median, min, max}; what is not above zero
 * cannot be shown and is left out. `guide`: slope and name of a line through the point that is best by it. `isWhole`:
 * x is marked at whole numbers only.
 */
function logPlot(curves, xTitle, yTitle, guide, isWhole = false) {
  // Drawn for the window there is, so that letters keep their size.
  const width = Math.max(420, Math.min(1150, document.body.clientWidth - 80)), height = Math.round(Math.max(320, 0.42 * width)), left = 72, right = 16, top = 12, bottom = 46;
  const shown = curves.map((curve) => ({ ...curve, points: curve.points.filter((point) => point.x.median > 0 && point.y.median > 0) }));
  const points = shown.flatMap((curve) => curve.points);
  const panel = make("div", { class: "panel plot" });
  if (!points.length) {
    panel.append(make("p", { class: "soft" }, "Nothing here is above zero, so there is nothing to draw on logarithmic axes."));
    return panel;
  }
  const xs = axis(points.flatMap((point) => [point.x.min, point.x.median, point.x.max]));
  const ys = axis(points.flatMap((point) => [point.y.min, point.y.median, point.y.max]));
  const xAt = (log) => left + ((log - xs[0]) / (xs[1] - xs[0])) * (width - left - right);
  const yAt = (log) => height - bottom - ((log - ys[0]) / (ys[1] - ys[0])) * (height - top - bottom);
  const log = (value, ends) => (value > 0 ? Math.max(ends[0], Math.log10(value)) : ends[0]);
  const x = (value) => xAt(log(value, xs)).toFixed(2), y = (value) => yAt(log(value, ys)).toFixed(2);

  const svg = make("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": `${yTitle} against ${xTitle}` });
  for (const { log, value } of ticks(xs).filter(({ value }) => !isWhole || Number.isInteger(value))) {
    const at = xAt(log);
    svg.append(make("line", { class: "grid", x1: at, x2: at, y1: top, y2: height - bottom }),
      make("text", { class: "quiet", x: at, y: height - bottom + 17, "text-anchor": "middle" }, String(Number(value.toPrecision(2)))));
  }
  for (const { log, value } of ticks(ys)) {
    const at = yAt(log), text = value < 1e-2 || value >= 1e4 ? value.toExponential(0) : String(Number(value.toPrecision(2)));
    svg.append(make("line", { class: "grid", x1: left, x2: width - right, y1: at, y2: at }),
      make("text", { class: "quiet", x: left - 8, y: at + 4, "text-anchor": "end" }, text));
  }
  svg.append(make("rect", { class: "frame", x: left, y: top, width: width - left - right, height: height - top - bottom }),
    make("text", { x: (left + width - right) / 2, y: height - 8, "text-anchor": "middle" }, xTitle),
    make("text", { x: 16, y: (top + height - bottom) / 2, "text-anchor": "middle", transform: `rotate(-90 16 ${(top + height - bottom) / 2})` }, yTitle));
  if (guide) svg.append(...guideLine(points, guide, xs, ys, xAt, yAt));

  const legend = make("div", { class: "legend" });
  shown.forEach((curve, number) => {
    const { colour, dash } = look(number);
    const group = make("g", { "data-curve": curve.label });
    for (const point of curve.points) {
      group.append(make("path", { class: "spread", stroke: colour, d:
        `M${x(point.x.min)} ${y(point.y.median)}H${x(point.x.max)}M${x(point.x.median)} ${y(point.y.min)}V${y(point.y.max)}` }));
    }
    if (curve.points.length > 1) {
      const d = curve.points.map((point, index) => `${index ? "L" : "M"}${x(point.x.median)} ${y(point.y.median)}`).join("");
      group.append(make("path", { class: "curve", stroke: colour, "stroke-dasharray": dash, d }));
    }
    for (const point of curve.points) {
      const text = `${curve.label}\n${point.text}`;
      const show = (event) => {
        const box = event.currentTarget.getBoundingClientRect();
        showTip(text, box.x + box.width / 2, box.y + box.height / 2);
      };
      group.append(make("circle", { class: "dot", fill: colour, cx: x(point.x.median), cy: y(point.y.median), r: 5.5, tabindex: 0,
        "aria-label": text.replaceAll("\n", ", "), pointerenter: show, focus: show, pointerleave: hideTip, blur: hideTip }));
    }
    svg.append(group);
    const sample = make("svg", { viewBox: "0 0 26 10" },
      make("path", { d: "M0 5H26", fill: "none", stroke: colour, "stroke-width": 2, "stroke-dasharray": dash }),
      make("circle", { cx: 13, cy: 5, r: 4, fill: colour }));
    legend.append(make("button", { class: "key", "aria-pressed": "true", title: "show or hide", click: (event) => {
      const isShown = group.style.display === "none";
      group.style.display = isShown ? "" : "none";
      event.currentTarget.setAttribute("aria-pressed", String(isShown));
    } }, sample, curve.label));
  });
  panel.append(legend, svg);
  return panel;
}

/** A line of this slope through the point that is best by it, cut to the frame, with its name. */
function guideLine(points, { slope, name }, xs, ys, xAt, yAt) {
  const height = (point) => Math.log10(point.y.median) - slope * Math.log10(point.x.median);
  const base = Math.min(...points.map(height));
  const at = (x) => base + slope * x;
  let [from, to] = xs;
  if (slope) {
    const ends = [(ys[0] - base) / slope, (ys[1] - base) / slope].sort((a, b) => a - b);
    from = Math.max(from, ends[0]);
    to = Math.min(to, ends[1]);
  }
  if (from >= to) return [];
  const label = from + 0.03 * (to - from);
  return [make("path", { class: "guide", d: `M${xAt(from).toFixed(2)} ${yAt(at(from)).toFixed(2)}L${xAt(to).toFixed(2)} ${yAt(at(to)).toFixed(2)}` }),
    make("text", { class: "quiet", x: xAt(label) + 6, y: Math.max(24, yAt(at(label)) - 4) }, name)];
}
