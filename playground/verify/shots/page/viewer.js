// viewer.js -- look at the pictures of one shot: side by side, swiped, blended, blinking, zoomed.
//
// All panes show the same part of the picture at the same zoom. Places are in pixels of the
// picture, from its top left; a pane's are in CSS pixels. Nothing is smoothed from one
// picture pixel to one screen pixel on.
"use strict";

const MODES = [
  { name: "all", label: "All", panes: ["expected", "actual", "difference", "flip", "masked"] },
  { name: "swipe", label: "Swipe", panes: ["both"] },
  { name: "onion", label: "Onion", panes: ["both"] },
  { name: "blink", label: "Blink", panes: ["both"] },
  { name: "difference", label: "Difference ×16", panes: ["difference"] },
  { name: "flip", label: "FLIP map", panes: ["flip"] },
];
const LABELS = {
  expected: "Expected",
  actual: "Actual",
  difference: "Difference ×16",
  flip: "FLIP map",
  masked: "Not compared",
};
const MAX_PIXEL_SIZE = 64; // [CSS pixels a picture pixel]
const GRID_FROM = 10; // [CSS pixels a picture pixel] below, a grid would hide what it parts
const NEAR = 22; // [CSS pixels] how near to the divider a finger takes it

/** What a person set, kept from shot to shot. */
const looks = { mode: "all", split: 0.5, blend: 0.5, rate: 2, running: true, side: "actual", mark: true };
looks.running = !matchMedia("(prefers-reduced-motion: reduce)").matches;

function make(name, properties = {}, ...inside) {
  const { dataset, attributes, ...rest } = properties;
  const element = Object.assign(document.createElement(name), rest);
  Object.assign(element.dataset, dataset ?? {});
  for (const [key, value] of Object.entries(attributes ?? {})) element.setAttribute(key, value);
  element.append(...inside);
  return element;
}

class Viewer {
  /** pictures: kind → {width, height, data, opaque, canvas}; place: [x, y] of the worst pixel, or null. */
  constructor(host, pictures, place, name) {
    this.host = host;
    this.pictures = pictures;
    this.place = place;
    this.name = name;
    this.width = Math.max(...Object.values(pictures).map((p) => p.width));
    this.height = Math.max(...Object.values(pictures).map((p) => p.height));
    this.x = this.width / 2; // the place in the middle of each pane
    this.y = this.height / 2;
    this.zoom = 0; // [CSS pixels a picture pixel]; 0: as large as the whole picture fits
    this.pixel = null; // the pixel whose values are shown
    this.fingers = new Map(); // pointer → where it was
    this.dividing = false;
    this.build();
    this.watcher = new ResizeObserver(() => this.draw());
    this.show(this.has(looks.mode) ? looks.mode : "all");
  }

  close() {
    clearInterval(this.timer);
    this.watcher.disconnect();
    this.host.replaceChildren();
    this.host.hidden = true;
  }

  /** Whether there are the pictures for a mode. */
  has(mode) {
    if (mode === "all") return true;
    if (mode === "difference" || mode === "flip") return mode in this.pictures;
    return "expected" in this.pictures && "actual" in this.pictures;
  }

  // What there is on the page

  build() {
    this.tabs = MODES.map((mode, index) =>
      make("button", {
        type: "button",
        textContent: mode.label,
        disabled: !this.has(mode.name),
        title: `key ${index + 1}`,
        onclick: () => this.show(mode.name),
      }),
    );
    const tabs = make("div", { className: "modes", attributes: { role: "group", "aria-label": "How to look" } });
    tabs.append(...this.tabs);
    const button = (label, text, action) =>
      make("button", { type: "button", title: label, textContent: text, onclick: action, attributes: { "aria-label": label } });
    this.level = make("output", { className: "level" });
    const zooms = make("div", { className: "zooms", attributes: { role: "group", "aria-label": "Zoom" } });
    zooms.append(
      button("Zoom out", "−", () => this.zoomBy(0.5)),
      this.level,
      button("Zoom in", "+", () => this.zoomBy(2)),
      button("Fit: the whole picture", "Fit", () => this.fit()),
      button("1:1, one pixel for one pixel", "1:1", () => this.zoomTo(1)),
    );
    if (this.place) zooms.append(button("Worst pixel: go there", "Worst pixel", () => this.goToWorst()));
    this.control = make("div", { className: "control" });
    this.panes = make("div", {
      className: "panes",
      tabIndex: 0,
      onkeydown: (event) => this.onKey(event),
      attributes: { role: "group", "aria-label": `Pictures of ${this.name}; arrow keys go from pixel to pixel` },
    });
    this.values = make("div", { className: "values", attributes: { "aria-live": "polite" } });
    this.host.replaceChildren(make("div", { className: "bar" }, tabs, zooms), this.control, this.panes, this.values);
    this.host.hidden = false;
  }

  show(mode) {
    if (!this.has(mode)) return;
    looks.mode = mode;
    this.mode = mode;
    MODES.forEach((other, i) => this.tabs[i].setAttribute("aria-pressed", String(other.name === mode)));
    clearInterval(this.timer);
    this.watcher.disconnect();
    const kinds = MODES.find((other) => other.name === mode).panes.filter((k) => k === "both" || k in this.pictures);
    this.canvases = kinds.map((kind) => this.pane(kind));
    this.panes.replaceChildren(...this.canvases.map((canvas) => canvas.parentElement));
    this.panes.dataset.count = kinds.length;
    this.buildControl();
    for (const canvas of this.canvases) this.watcher.observe(canvas);
    this.tick();
    this.draw();
    this.say();
  }

  pane(kind) {
    const label = kind === "both" ? "Expected and actual" : LABELS[kind];
    const canvas = make("canvas", {
      dataset: { kind },
      attributes: { role: "img", "aria-label": `${this.name}: ${label}` },
    });
    canvas.style.aspectRatio = `${this.width} / ${this.height}`;
    canvas.addEventListener("pointerdown", (event) => this.onDown(event, canvas));
    canvas.addEventListener("pointermove", (event) => this.onMove(event, canvas));
    for (const end of ["pointerup", "pointercancel"])
      canvas.addEventListener(end, (event) => this.onUp(event));
    canvas.addEventListener("dblclick", (event) => this.onDouble(event, canvas));
    canvas.addEventListener("wheel", (event) => this.onWheel(event, canvas), { passive: false });
    const caption = make("figcaption");
    if (kind !== "both") caption.append(label);
    else if (this.mode === "blink") caption.append(make("span", { className: "turn" }));
    else caption.append(make("span", { textContent: "Expected" }), make("span", { textContent: "Actual" }));
    return make("figure", { className: "pane" }, caption, canvas).lastChild;
  }

  buildControl() {
    const range = (label, key, least, most, step, words) => {
      const shown = make("output");
      const input = make("input", { type: "range", min: least, max: most, step, value: looks[key] });
      input.oninput = () => {
        looks[key] = Number(input.value);
        shown.textContent = words(looks[key]);
        input.setAttribute("aria-valuetext", words(looks[key]));
        if (key === "rate") this.tick();
        this.draw();
      };
      input.oninput();
      this.range = input;
      return make("label", {}, make("span", { textContent: label }), input, shown);
    };
    const percent = (value) => `${Math.round(value * 100)} %`;
    this.range = null;
    this.control.replaceChildren();
    if (this.mode === "swipe") {
      this.control.append(range("Divider", "split", 0, 1, 0.01, (v) => `${percent(v)} expected`));
    } else if (this.mode === "onion") {
      this.control.append(range("Blend", "blend", 0, 1, 0.01, (v) => `${percent(v)} actual`));
    } else if (this.mode === "blink") {
      // Six changes are three flashes a second: more can harm (WCAG 2.2, 2.3.1).
      const words = (v) => `${v} changes a second`;
      this.play = make("button", { type: "button", onclick: () => this.toggleBlink() });
      this.control.append(this.play, range("Rate", "rate", 0.5, 6, 0.5, words));
    }
  }

  // Blinking

  toggleBlink() {
    looks.running = !looks.running;
    this.tick();
    this.draw();
  }

  tick() {
    clearInterval(this.timer);
    if (this.mode !== "blink") return;
    this.play.textContent = looks.running ? "Stop" : "Go on";
    if (!looks.running) return;
    this.timer = setInterval(() => {
      looks.side = looks.side === "actual" ? "expected" : "actual";
      this.draw();
    }, 1000 / looks.rate);
  }

  /** Show only one of the two pictures, where both are shown. */
  only(side) {
    if (this.mode === "swipe") this.setRange(side === "expected" ? 1 : 0);
    else if (this.mode === "onion") this.setRange(side === "expected" ? 0 : 1);
    else if (this.mode === "blink") {
      looks.running = false;
      looks.side = side;
      this.tick();
      this.draw();
    }
  }

  setRange(value) {
    if (!this.range) return;
    this.range.value = value;
    this.range.oninput();
  }

  nudge(direction) {
    if (this.range) this.setRange(Number(this.range.value) + direction * (this.mode === "blink" ? 0.5 : 0.05));
  }

  // Zoom and place

  /** The scale at which the whole picture fits into a pane. */
  fitting(canvas = this.canvases[0]) {
    return Math.min(canvas.clientWidth / this.width, canvas.clientHeight / this.height) || 1;
  }

  scale(canvas = this.canvases[0]) {
    return this.zoom || this.fitting(canvas);
  }

  fit() {
    this.zoom = 0;
    this.x = this.width / 2;
    this.y = this.height / 2;
    this.draw();
  }

  /** Zoom so that the place (x, y) stays where it is in the pane. */
  zoomTo(scale, x = this.pixel ? this.pixel[0] + 0.5 : this.x, y = this.pixel ? this.pixel[1] + 0.5 : this.y) {
    const before = this.scale();
    const least = this.fitting();
    const after = Math.min(Math.max(scale, Math.min(least, 1)), MAX_PIXEL_SIZE);
    if (after <= least && scale < before) return this.fit();
    this.x = x + ((this.x - x) * before) / after;
    this.y = y + ((this.y - y) * before) / after;
    this.zoom = after;
    this.draw();
  }

  zoomBy(factor, x, y) {
    // From the whole picture the first step goes to a power of two, so that pixels are squares.
    const now = this.scale();
    const exact = this.zoom || Math.abs(Math.log2(factor)) !== 1;
    const power = factor > 1 ? 2 ** Math.floor(Math.log2(now) + 1) : 2 ** Math.ceil(Math.log2(now) - 1);
    this.zoomTo(exact ? now * factor : power, x, y);
  }

  goToWorst() {
    if (!this.place) return;
    looks.mark = true;
    [this.x, this.y] = [this.place[0] + 0.5, this.place[1] + 0.5];
    this.zoom = 16;
    this.point(...this.place);
    this.draw();
  }

  /** Keep what is shown on the picture. */
  clamp() {
    const canvas = this.canvases[0];
    const scale = this.scale();
    const within = (at, whole, pane) => {
      const half = pane / 2 / scale;
      return half * 2 >= whole ? whole / 2 : Math.min(Math.max(at, half), whole - half);
    };
    this.x = within(this.x, this.width, canvas.clientWidth);
    this.y = within(this.y, this.height, canvas.clientHeight);
  }

  /** The place of the picture under a pointer, and where that is in the pane. */
  under(event, canvas) {
    const box = canvas.getBoundingClientRect();
    const [left, top] = [event.clientX - box.left, event.clientY - box.top];
    const scale = this.scale(canvas);
    return {
      left,
      top,
      x: this.x + (left - canvas.clientWidth / 2) / scale,
      y: this.y + (top - canvas.clientHeight / 2) / scale,
    };
  }

  // Pointers and keys

  onDown(event, canvas) {
    canvas.setPointerCapture(event.pointerId);
    const at = this.under(event, canvas);
    this.fingers.set(event.pointerId, at);
    const divider = looks.split * canvas.clientWidth;
    this.dividing =
      this.mode === "swipe" && this.fingers.size === 1 && (!this.zoom || Math.abs(at.left - divider) < NEAR);
    if (this.dividing) this.setRange(at.left / canvas.clientWidth);
    this.point(Math.floor(at.x), Math.floor(at.y));
  }

  onMove(event, canvas) {
    const at = this.under(event, canvas);
    const before = this.fingers.get(event.pointerId);
    if (before && this.fingers.size === 2) this.pinch(event.pointerId, before, at);
    else if (before && this.dividing) this.setRange(at.left / canvas.clientWidth);
    else if (before && this.zoom) {
      const scale = this.scale(canvas);
      this.x -= (at.left - before.left) / scale;
      this.y -= (at.top - before.top) / scale;
      this.draw();
    }
    if (before) this.fingers.set(event.pointerId, this.under(event, canvas));
    const now = this.under(event, canvas);
    if (event.pointerType === "mouse" || !before) this.point(Math.floor(now.x), Math.floor(now.y));
  }

  pinch(pointer, before, at) {
    const other = [...this.fingers].find(([id]) => id !== pointer)[1];
    const apart = (a, b) => Math.hypot(a.left - b.left, a.top - b.top) || 1;
    this.zoomTo((this.scale() * apart(at, other)) / apart(before, other), (before.x + other.x) / 2, (before.y + other.y) / 2);
  }

  onUp(event) {
    this.fingers.delete(event.pointerId);
    if (!this.fingers.size) this.dividing = false;
  }

  onDouble(event, canvas) {
    const at = this.under(event, canvas);
    if (this.zoom >= 16) this.fit();
    else this.zoomTo(Math.max(8, this.scale() * 4), at.x, at.y);
  }

  onWheel(event, canvas) {
    if (!event.ctrlKey && !event.metaKey) return; // the page scrolls
    event.preventDefault();
    const at = this.under(event, canvas);
    this.zoomTo(this.scale() * 2 ** (-event.deltaY / 200), at.x, at.y);
  }

  onKey(event) {
    const steps = { ArrowLeft: [-1, 0], ArrowRight: [1, 0], ArrowUp: [0, -1], ArrowDown: [0, 1] };
    const step = steps[event.key];
    if (!step || event.ctrlKey || event.metaKey || event.altKey) return;
    event.preventDefault();
    const far = event.shiftKey ? 10 : 1;
    const [x, y] = this.pixel ?? this.place ?? [Math.floor(this.x), Math.floor(this.y)];
    const from = this.pixel ? far : 0; // the first key shows where one is
    this.point(x + step[0] * from, y + step[1] * from);
    const canvas = this.canvases[0];
    const scale = this.scale();
    const half = [canvas.clientWidth / 2 / scale - 1, canvas.clientHeight / 2 / scale - 1];
    this.x = Math.min(Math.max(this.x, this.pixel[0] + 0.5 - half[0]), this.pixel[0] + 0.5 + half[0]);
    this.y = Math.min(Math.max(this.y, this.pixel[1] + 0.5 - half[1]), this.pixel[1] + 0.5 + half[1]);
    this.draw();
  }

  point(x, y) {
    const pixel = [Math.min(Math.max(x, 0), this.width - 1), Math.min(Math.max(y, 0), this.height - 1)];
    if (this.pixel && pixel[0] === this.pixel[0] && pixel[1] === this.pixel[1]) return;
    this.pixel = pixel;
    this.say();
    this.draw();
  }

  // What is at the pixel

  at(kind, x, y) {
    const picture = this.pictures[kind];
    if (!picture || x >= picture.width || y >= picture.height) return null;
    return [...picture.data.subarray((y * picture.width + x) * 4, (y * picture.width + x) * 4 + 4)];
  }

  say() {
    if (!this.pixel) {
      this.values.replaceChildren("Point at a pixel to read its values: red, green, blue and alpha, 0 to 255.");
      return;
    }
    const [x, y] = this.pixel;
    const [expected, actual] = [this.at("expected", x, y), this.at("actual", x, y)];
    const parts = [make("span", { className: "where", textContent: `x ${x}, y ${y}` })];
    for (const [label, colour] of [["expected", expected], ["actual", actual]]) {
      if (!(label in this.pictures)) continue;
      const swatch = make("span", { className: "swatch" });
      if (colour) swatch.style.background = `rgb(${colour.slice(0, 3).join(" ")} / ${colour[3] / 255})`;
      const text = colour ? colour.join(" ") : "nothing";
      parts.push(make("span", {}, `${label} `, swatch, make("b", { textContent: text })));
    }
    if (expected && actual) {
      const differences = actual.map((value, channel) => value - expected[channel]);
      const text = differences.map((d) => (d > 0 ? `+${d}` : d < 0 ? `−${-d}` : "0")).join(" ");
      parts.push(make("span", {}, "difference ", make("b", { textContent: text })));
    }
    this.values.replaceChildren(...parts);
  }

  // Drawing

  draw() {
    if (this.asked) return;
    this.asked = requestAnimationFrame(() => {
      this.asked = 0;
      if (!this.panes.isConnected) return;
      this.clamp();
      const scale = this.scale();
      this.level.textContent = `${scale < 10 ? Math.round(scale * 100) : Math.round(scale) * 100} %`;
      this.panes.classList.toggle("zoomed", Boolean(this.zoom));
      this.canvases.forEach((canvas) => this.drawPane(canvas));
    });
  }

  drawPane(canvas) {
    const ratio = devicePixelRatio || 1;
    const [width, height] = [canvas.clientWidth, canvas.clientHeight];
    if (!width || !height) return;
    const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
    if (canvas.width !== across || canvas.height !== down) [canvas.width, canvas.height] = [across, down];
    const context = canvas.getContext("2d");
    const scale = this.scale(canvas);
    context.setTransform(ratio, 0, 0, ratio, 0, 0);
    context.clearRect(0, 0, width, height);
    context.imageSmoothingEnabled = scale * ratio < 1;
    context.imageSmoothingQuality = "high";
    const left = width / 2 - this.x * scale;
    const top = height / 2 - this.y * scale;
    const put = (kind, on = context) => {
      const picture = this.pictures[kind];
      if (!picture) return;
      const box = [left, top, picture.width * scale, picture.height * scale];
      if (!picture.opaque) {
        on.fillStyle = chequers(on);
        on.fillRect(...box);
      }
      on.drawImage(picture.canvas, ...box);
    };
    const clipped = (from, to, action) => {
      context.save();
      context.beginPath();
      context.rect(from, 0, to - from, height);
      context.clip();
      action();
      context.restore();
    };
    const kind = canvas.dataset.kind;
    if (kind !== "both") put(kind);
    else if (this.mode === "onion") {
      put("expected");
      const layer = new OffscreenCanvas(across, down); // first over its ground, then over the other
      const above = layer.getContext("2d");
      above.setTransform(ratio, 0, 0, ratio, 0, 0);
      above.imageSmoothingEnabled = context.imageSmoothingEnabled;
      above.imageSmoothingQuality = "high";
      put("actual", above);
      context.globalAlpha = looks.blend;
      context.drawImage(layer, 0, 0, width, height);
      context.globalAlpha = 1;
    } else if (this.mode === "blink") {
      put(looks.side);
      const turn = canvas.parentElement.querySelector(".turn");
      turn.textContent = LABELS[looks.side];
      turn.dataset.side = looks.side;
    } else {
      const at = looks.split * width;
      clipped(0, at, () => put("expected"));
      clipped(at, width, () => put("actual"));
      divider(context, at, height);
    }
    if (scale >= GRID_FROM) grid(context, left, top, scale, width, height);
    if (this.place && looks.mark) ring(context, left, top, scale, this.place);
    if (this.pixel && scale >= 4) frame(context, left, top, scale, this.pixel);
  }
}

// Marks are white between black, so that they show on any colour.

function strokeTwice(context, path, width = 1.5) {
  for (const [colour, w] of [["#000", width + 2], ["#fff", width]]) {
    context.beginPath();
    path();
    context.strokeStyle = colour;
    context.lineWidth = w;
    context.stroke();
  }
}

function ring(context, left, top, scale, [x, y]) {
  const [cx, cy] = [left + (x + 0.5) * scale, top + (y + 0.5) * scale];
  const radius = Math.max(9, scale * 1.2);
  strokeTwice(context, () => context.arc(cx, cy, radius, 0, 2 * Math.PI));
}

function frame(context, left, top, scale, [x, y]) {
  strokeTwice(context, () => context.rect(left + x * scale, top + y * scale, scale, scale), 1);
}

function divider(context, at, height) {
  strokeTwice(context, () => (context.moveTo(at, 0), context.lineTo(at, height)), 2);
  const middle = height - 24; // below the middle, where the worst pixel is gone to
  context.beginPath();
  context.arc(at, middle, 14, 0, 2 * Math.PI);
  context.fillStyle = "#fff";
  context.fill();
  strokeTwice(context, () => context.arc(at, middle, 14, 0, 2 * Math.PI), 1);
  context.beginPath();
  for (const side of [-1, 1]) {
    context.moveTo(at + side * 4, middle - 5);
    context.lineTo(at + side * 9, middle);
    context.lineTo(at + side * 4, middle + 5);
  }
  context.strokeStyle = "#000";
  context.lineWidth = 2;
  context.stroke();
}

function grid(context, left, top, scale, width, height) {
  context.beginPath();
  for (let x = left % scale; x <= width; x += scale) {
    context.moveTo(x, 0);
    context.lineTo(x, height);
  }
  for (let y = top % scale; y <= height; y += scale) {
    context.moveTo(0, y);
    context.lineTo(width, y);
  }
  context.strokeStyle = "rgb(128 128 128 / 0.35)";
  context.lineWidth = 1;
  context.stroke();
}

let chequered = null;
function chequers(context) {
  if (!chequered) {
    const canvas = make("canvas", { width: 16, height: 16 });
    const small = canvas.getContext("2d");
    small.fillStyle = "#bbb";
    small.fillRect(0, 0, 16, 16);
    small.fillStyle = "#888";
    small.fillRect(0, 0, 8, 8);
    small.fillRect(8, 8, 8, 8);
    chequered = context.createPattern(canvas, "repeat");
  }
  return chequered;
}
