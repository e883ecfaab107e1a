// Two images of one scene on top of each other: flip, wipe, side by side; errors in false colours; values under the pointer.

/** What black and white of an error map mean; the program writes them with these numbers. */
const LOWEST = 1e-6, DECADES = 8;

/** Inferno, as polynomials (Matt Zucker, public domain): colour of a share in [0, 1], each channel in [0, 255]. */
function inferno(t) {
  const terms = [[0.00021894, 0.001651, -0.0194809], [0.1065134, 0.5639564, 3.9327124], [11.6024931, -3.972854, -15.9423941], [-41.7039961, 17.4363989, 44.3541452],
    [77.1629357, -33.4023589, -81.8073093], [-71.3194282, 32.6260643, 73.2095199], [25.1311262, -12.242669, -23.0703250]];
  return [0, 1, 2].map((channel) => 255 * Math.min(1, Math.max(0, terms.reduceRight((sum, term) => sum * t + term[channel], 0))));
}

const COLOURS = Array.from({ length: 256 }, (_, index) => inferno(index / 255));

/** Pixels of a picture by its path: {width, height, data} as bytes, four a pixel. */
const decoded = new Map();
function pixels(path) {
  if (!path || !DATA.pictures[path]) return Promise.resolve(null);
  if (!decoded.has(path)) {
    decoded.set(path, new Promise((resolve, reject) => {
      const image = new Image();
      image.onload = () => {
        const canvas = make("canvas", { width: image.width, height: image.height });
        const context = canvas.getContext("2d", { willReadFrequently: true });
        context.drawImage(image, 0, 0);
        resolve(context.getImageData(0, 0, image.width, image.height));
      };
      image.onerror = () => reject(new Error(`${path} cannot be shown`));
      image.src = DATA.pictures[path];
    }));
  }
  return decoded.get(path);
}

/** Everything there is to see of one render, decoded: picture, error map, and linear values where the file has them. */
async function decode(entry) {
  const [picture, errors, packed] = await Promise.all([pixels(entry.picture), pixels(entry.errorMap), pixels(entry.linear)]);
  let linear = null;
  if (packed) {
    const count = (packed.width * packed.height) / 2;
    linear = new Float32Array(3 * count);
    for (let i = 0; i < count; i++) {
      const exponent = packed.data[4 * (count + i)] - 128, scale = 2 ** exponent / 256;
      for (let c = 0; c < 3; c++) linear[3 * i + c] = exponent === -127 ? 0 : (packed.data[4 * i + c] + 0.5) * scale;
    }
  }
  return { entry, picture, errors, linear, width: picture.width, height: picture.height, canvases: new Map() };
}

/** A canvas of the image at this exposure (stops), or of its errors; null where it has none. */
function painted(image, layer, exposure) {
  const key = layer === "error" ? "error" : image.linear ? `image${exposure}` : "image";
  if (layer === "error" && !image.errors) return null;
  if (!image.canvases.has(key)) {
    const { width, height } = image, out = new ImageData(width, height);
    const factor = 2 ** exposure;
    const curve = (x) => 255 * (x <= 0.0031308 ? 12.92 * x : 1.055 * Math.min(1, x) ** (1 / 2.4) - 0.055);
    for (let i = 0; i < width * height; i++) {
      let colour;
      if (layer === "error") colour = COLOURS[image.errors.data[4 * i]];
      else if (image.linear && exposure !== 0) colour = [0, 1, 2].map((c) => curve(factor * image.linear[3 * i + c]));
      else colour = image.picture.data.subarray(4 * i, 4 * i + 3);
      out.data.set(colour, 4 * i);
      out.data[4 * i + 3] = 255;
    }
    const canvas = make("canvas", { width, height });
    canvas.getContext("2d").putImageData(out, 0, 0);
    // One exposure at a time is kept.
    if (layer !== "error") for (const old of [...image.canvases.keys()]) if (old !== "error") image.canvases.delete(old);
    image.canvases.set(key, canvas);
  }
  return image.canvases.get(key);
}

/** Renders that can be laid over each other, by reference: Map of name to [{label, picture, errorMap, linear}]. */
function imageSets() {
  const sets = new Map();
  for (const reference of RESULTS.references) {
    if (reference.picture) sets.set(reference.name, [{ ...reference, label: "reference" }]);
  }
  for (const plot of DATA.plots) {
    for (const [index, label] of plot.series) {
      const series = RESULTS.series[index];
      if (!series.picture) continue;
      // Without a reference of its own a render goes with the first of its scene.
      const name = series.reference ?? [...sets.keys()].find((known) => known.startsWith(`${series.scene}-`)) ?? series.scene;
      if (!sets.has(name)) sets.set(name, []);
      const set = sets.get(name);
      if (!set.some((known) => known.picture === series.picture)) {
        const samples = series.points[series.points.length - 1].samples;
        const title = DATA.plots.filter((other) => other.scene === plot.scene).length > 1 ? `${plot.title}: ` : "";
        set.push({ ...series, label: `${title}${label}${samples ? `, ${samples} samples` : ""}` });
      }
    }
  }
  return sets;
}

function viewer() {
  const sets = imageSets();
  if (!sets.size) return null;
  const state = { a: null, b: null, mode: "flip", layer: "image", exposure: 0, scale: 1, x: 0, y: 0, wipe: 0.5, isB: false, mouse: null };
  const canvas = make("canvas", { class: "view" }), context = canvas.getContext("2d");
  const chips = { a: make("span", { class: "chip a" }), b: make("span", { class: "chip b" }) };
  const stage = make("div", { class: "stage", tabindex: 0, role: "application", "aria-label": "Image viewer: Space flips, arrows move, plus and minus zoom" }, canvas, chips.a, chips.b);
  const out = make("div", { class: "out" });
  const choose = { set: make("select"), a: make("select"), b: make("select") };
  const modes = ["flip", "wipe", "side"].map((mode) => make("button", { class: "mode", "data-mode": mode, click: () => change({ mode }) }, { flip: "Flip", wipe: "Wipe", side: "Side by side" }[mode]));
  const layers = ["image", "error"].map((layer) => make("button", { class: "mode", "data-layer": layer, click: () => change({ layer }) }, { image: "Image", error: "Error" }[layer]));
  const flip = make("button", { click: () => change({ isB: !state.isB }), pointerenter: (event) => event.pointerType === "mouse" && change({ isB: true }),
    pointerleave: (event) => event.pointerType === "mouse" && change({ isB: false }), title: "hover to see B, leave to see A" }, "A ⇄ B");
  const exposure = make("input", { type: "range", min: -6, max: 6, step: 0.5, value: 0, input: () => change({ exposure: Number(exposure.value) }) });
  const wipe = make("input", { type: "range", min: 0, max: 1, step: 0.005, value: 0.5, input: () => change({ wipe: Number(wipe.value) }) });
  const wipeLabel = make("label", {}, "wipe", wipe);

  const scale = make("canvas", { width: 256, height: 1 });
  const ramp = scale.getContext("2d");
  COLOURS.forEach((colour, x) => { ramp.fillStyle = `rgb(${colour.map(Math.round).join(" ")})`; ramp.fillRect(x, 0, 1, 1); });
  const colours = make("div", { class: "colours" }, make("span", {}, "squared relative error"), make("span", {}, "10⁻⁶"), scale, make("span", {}, "10²"));

  /** Width of one picture on the canvas, in CSS pixels: half of it side by side. */
  const pane = () => (state.mode === "side" ? stage.clientWidth / 2 : stage.clientWidth);
  const height = () => Math.max(160, Math.min((pane() * (state.a?.height ?? 1)) / (state.a?.width ?? 1), 0.8 * innerHeight));

  function fit() {
    if (!state.a) return;
    state.scale = Math.min(pane() / state.a.width, height() / state.a.height);
    state.x = (pane() - state.scale * state.a.width) / 2;
    state.y = (height() - state.scale * state.a.height) / 2;
  }

  function change(what) {
    const isOther = what.mode && what.mode !== state.mode;
    Object.assign(state, what);
    if (isOther) fit();
    draw();
  }

  function draw() {
    if (!state.a || !state.b || !stage.clientWidth) return;
    const ratio = devicePixelRatio || 1, w = stage.clientWidth, h = height();
    canvas.width = Math.round(w * ratio);
    canvas.height = Math.round(h * ratio);
    canvas.style.height = `${h}px`;
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    // Pixels stay pixels.
    context.imageSmoothingEnabled = false;
    const paint = (image, left, from, to) => {
      context.save();
      context.beginPath();
      context.rect(from, 0, to - from, h);
      context.clip();
      const source = painted(image, state.layer, state.exposure);
      if (source) context.drawImage(source, left + state.x, state.y, state.scale * state.a.width, state.scale * state.a.height);
      else {
        context.fillStyle = "#999";
        context.font = "14px system-ui, sans-serif";
        context.fillText("no error map: this is the reference, or it was not measured here", from + 16, h / 2);
      }
      context.restore();
    };
    if (state.mode === "flip") paint(state.isB ? state.b : state.a, 0, 0, w);
    if (state.mode === "wipe") {
      paint(state.a, 0, 0, state.wipe * w);
      paint(state.b, 0, state.wipe * w, w);
    }
    if (state.mode === "side") {
      paint(state.a, 0, 0, w / 2);
      paint(state.b, w / 2, w / 2, w);
    }
    if (state.mode !== "flip") {
      context.fillStyle = "#fff";
      context.fillRect((state.mode === "wipe" ? state.wipe : 0.5) * w - 1, 0, 2, h);
    }
    chips.a.textContent = `A: ${state.a.entry.label}`;
    chips.b.textContent = `B: ${state.b.entry.label}`;
    chips.a.hidden = state.mode === "flip" && state.isB;
    chips.b.hidden = state.mode === "flip" && !state.isB;
    for (const button of modes) button.setAttribute("aria-pressed", String(button.dataset.mode === state.mode));
    for (const button of layers) button.setAttribute("aria-pressed", String(button.dataset.layer === state.layer));
    stage.dataset.shown = state.mode === "flip" ? (state.isB ? "b" : "a") : state.mode;
    stage.dataset.layer = state.layer;
    stage.dataset.scale = state.scale.toFixed(4);
    wipeLabel.hidden = state.mode !== "wipe";
    colours.style.visibility = state.layer === "error" ? "visible" : "hidden";
    read();
  }

  /** The values under the pointer. */
  function read() {
    const lines = [];
    if (state.mouse) {
      const { width, height } = state.a;
      const inPane = state.mode === "side" && state.mouse.x >= pane() ? state.mouse.x - pane() : state.mouse.x;
      const x = Math.floor((inPane - state.x) / state.scale), y = Math.floor((state.mouse.y - state.y) / state.scale);
      if (x >= 0 && y >= 0 && x < width && y < height) {
        lines.push(["pixel", `column ${x}, row ${y}`]);
        for (const [name, image] of [["A", state.a], ["B", state.b]]) lines.push([name, values(image, y * image.width + x)]);
      }
    }
    out.replaceChildren(...(lines.length ? lines.flatMap(([name, text]) => [make("span", { class: "soft" }, name), make("span", {}, text)])
      : [make("span", { class: "soft" }, "pixel"), make("span", { class: "soft" }, "point at the image")]));
  }

  function values(image, pixel) {
    const rgb = image.linear ? [...image.linear.subarray(3 * pixel, 3 * pixel + 3)].map(digits).join("  ")
      : `sRGB ${[...image.picture.data.subarray(4 * pixel, 4 * pixel + 3)].join("  ")}`;
    const grey = image.errors?.data[4 * pixel];
    const error = grey === undefined ? "" : `   squared relative error ${grey === 0 ? "≤ 1e-6" : (LOWEST * 10 ** ((DECADES * grey) / 255)).toExponential(1)}`;
    return `${rgb}${error}`;
  }

  function zoom(factor, x = pane() / 2, y = height() / 2) {
    const next = Math.min(64, Math.max(0.1, state.scale * factor));
    state.x = x - ((x - state.x) * next) / state.scale;
    state.y = y - ((y - state.y) * next) / state.scale;
    state.scale = next;
    draw();
  }

  let chosen = 0;
  async function load(refit) {
    const ticket = ++chosen, set = sets.get(choose.set.value);
    const [a, b] = await Promise.all([choose.a, choose.b].map((select) => decode(set[Number(select.value)])));
    // A later choice may have been decoded earlier.
    if (ticket !== chosen) return;
    Object.assign(state, { a, b });
    if (refit) fit();
    draw();
  }

  function fill() {
    const set = sets.get(choose.set.value);
    const options = () => set.map((entry, index) => make("option", { value: index }, entry.label));
    choose.a.replaceChildren(...options());
    choose.b.replaceChildren(...options());
    // A is a render, B the reference.
    choose.a.value = String(Math.min(1, set.length - 1));
    choose.b.value = "0";
    load(true);
  }

  choose.set.append(...[...sets.keys()].map((name) => make("option", { value: name }, name)));
  choose.set.addEventListener("change", fill);
  choose.a.addEventListener("change", () => load(false));
  choose.b.addEventListener("change", () => load(false));

  const keys = {
    " ": () => change({ isB: !state.isB }), f: () => change({ isB: !state.isB }),
    e: () => change({ layer: state.layer === "error" ? "image" : "error" }),
    m: () => change({ mode: { flip: "wipe", wipe: "side", side: "flip" }[state.mode] }),
    "+": () => zoom(1.5), "=": () => zoom(1.5), "-": () => zoom(1 / 1.5), 0: () => { fit(); draw(); },
    ArrowLeft: () => { state.x += 40; draw(); }, ArrowRight: () => { state.x -= 40; draw(); },
    ArrowUp: () => { state.y += 40; draw(); }, ArrowDown: () => { state.y -= 40; draw(); },
    ",": () => { wipe.value = state.wipe - 0.05; change({ wipe: Number(wipe.value) }); }, ".": () => { wipe.value = state.wipe + 0.05; change({ wipe: Number(wipe.value) }); },
  };
  stage.addEventListener("keydown", (event) => {
    if (!state.a || event.ctrlKey || event.metaKey || event.altKey || !keys[event.key]) return;
    event.preventDefault();
    keys[event.key]();
  });
  stage.addEventListener("wheel", (event) => {
    if (!state.a) return;
    event.preventDefault();
    zoom(Math.exp(-0.002 * event.deltaY), event.offsetX % pane(), event.offsetY);
  }, { passive: false });
  let drag = null;
  stage.addEventListener("pointerdown", (event) => {
    if (!state.a) return;
    stage.setPointerCapture(event.pointerId);
    const isDivider = state.mode === "wipe" && Math.abs(event.offsetX - state.wipe * stage.clientWidth) < 14;
    drag = { x: event.clientX, y: event.clientY, isDivider, isMoved: false };
  });
  stage.addEventListener("pointermove", (event) => {
    if (!state.a) return;
    state.mouse = { x: event.offsetX, y: event.offsetY };
    if (drag) {
      const [dx, dy] = [event.clientX - drag.x, event.clientY - drag.y];
      drag.isMoved ||= Math.hypot(dx, dy) > 3;
      if (drag.isDivider) {
        wipe.value = event.offsetX / stage.clientWidth;
        state.wipe = Number(wipe.value);
      } else if (drag.isMoved) {
        Object.assign(state, { x: state.x + dx, y: state.y + dy });
        Object.assign(drag, { x: event.clientX, y: event.clientY });
      }
      draw();
    } else read();
  });
  stage.addEventListener("pointerup", () => {
    // A click without a move flips.
    if (drag && !drag.isMoved && !drag.isDivider && state.mode === "flip") change({ isB: !state.isB });
    drag = null;
  });
  stage.addEventListener("pointercancel", () => { drag = null; });
  stage.addEventListener("pointerleave", () => { state.mouse = null; read(); });
  let lastWidth = 0;
  // Only another width matters: the height is what drawing sets, and drawing within the notice would raise the next one.
  new ResizeObserver(() => {
    if (stage.clientWidth === lastWidth) return;
    lastWidth = stage.clientWidth;
    requestAnimationFrame(() => { fit(); draw(); });
  }).observe(stage);
  // The first images are decoded when they are about to be seen.
  const watch = new IntersectionObserver((seen) => { if (seen.some((one) => one.isIntersecting)) { watch.disconnect(); fill(); } }, { rootMargin: "400px" });
  watch.observe(stage);

  const key = (name) => make("kbd", {}, name);
  return make("section", { id: "images" }, make("h2", {}, "Images"),
    make("p", { class: "soft" }, "Of the largest budget, first run. Click or ", key("Space"), " flips A and B, ", key("m"), " changes between flip, wipe and side by side, ", key("e"), " shows errors; wheel, ",
      key("+"), " and ", key("−"), " zoom, drag and arrows move, ", key("0"), " fits, ", key(","), " and ", key("."), " wipe."),
    make("div", { class: "panel viewer" },
      make("div", { class: "bar" }, make("label", {}, "scene", choose.set), make("label", {}, "A", choose.a), make("label", {}, "B", choose.b)),
      make("div", { class: "bar" }, flip, make("span", { class: "group" }, modes), make("span", { class: "group" }, layers), make("label", {}, "exposure", exposure), wipeLabel, colours),
      stage, out));
}
