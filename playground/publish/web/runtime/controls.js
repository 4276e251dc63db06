// controls.js -- a row of the panel for each parameter: its label, what changes it, its reset.

import { button, make, svg } from "./dom.js";
import {
  clamp, dragSpeed, fromHex, isLog, isWhole, partNames, rangeOf, scaleOf, snapped, tidied, toHex, unitOf,
  WIDGETS, written,
} from "./numbers.js";

/** @import { Shown, Value } from "./schema.js" */

// ── One number of a parameter: a field, and a slider where it has a range, else a drag.

/** @typedef {object} Line
 *  @property {number} part                    which number of the parameter
 *  @property {() => number} largest           of its vector: how fast a drag without a range goes
 *  @property {(number: number) => void} changed
 *  @property {string} [name]                  of the part
 *  @property {string} [unit]                  as it follows the number */

const STEPS = 1000; // of a slider without steps of its own
const PAD = 500; // pixels of a drag through the range of a number that has a pad instead of a slider
/** Letters from which on a unit is written after the label, and not after the number. */
export const LONG = 4;

/** @param {Shown} one @param {Line} line */
function numberLine(one, { part, largest, changed, name = "", unit = unitOf(one) }) {
  const { control, limits } = WIDGETS[one.widget], whole = isWhole(one.type);
  const range = limits?.[part] ?? rangeOf(one, part);
  const scale = ["direction", "point"].includes(control) ? null : scaleOf(one, part); // those have a pad
  const span = range ? range[1] - range[0] : 0;
  const field = make("input", { type: "text", inputMode: "decimal", className: "number" });
  field.autocomplete = "off";
  const element = make("label", { className: "part" });
  if (name) element.append(make("span", { className: "part-name" }, name));
  let now = 0;

  function set(/** @type {number} */ number) {
    if (!Number.isFinite(number)) return show(now);
    const held = range ? clamp(number, ...range) : number;
    return changed(whole ? Math.round(held) : tidied(held));
  }

  const own = !isLog(one.widget) && (one.step || (whole && span <= STEPS ? 1 : 0));
  const step = own ? own / span : 1 / STEPS;
  const slider = scale && make("input", { type: "range", min: 0, max: 1, step });
  if (slider) {
    slider.oninput = () => changed(scale.value(+slider.value));
    element.append(slider);
  } else {
    element.classList.add("free");
    whileDragged(element, (by) => {
      const speed = span ? span / PAD : dragSpeed(one, largest());
      set(snapped(one, now + by * speed, part));
    });
  }
  element.append(field);

  field.onchange = () => set(Number(field.value.replace(",", ".").replace(/[^\d.eE+-]*$/, "") || NaN));
  field.onkeydown = (event) => {
    const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (event.key === "Enter") field.select();
    if (!way) return;
    event.preventDefault();
    const by = one.step || (whole ? 1 : scale ? span / STEPS : dragSpeed(one, largest()));
    set(snapped(one, now + way * by * (event.shiftKey ? 10 : 1), part));
  };

  function show(/** @type {number} */ number) {
    now = number;
    const text = written(one, number, part);
    field.value = text + (unit.length < LONG ? unit : "");
    if (!slider || !scale) return;
    slider.value = String(scale.share(number));
    slider.style.setProperty("--share", String(scale.share(number)));
    slider.setAttribute("aria-valuetext", text + unit);
  }
  return { element, show, inputs: slider ? [slider, field] : [field] };
}

/** Drag on a line, but for its field: calls with the pixels gone since the last call.
 *  @param {HTMLElement} element @param {(by: number) => void} moved */
function whileDragged(element, moved) {
  let at = 0;
  element.onpointerdown = (event) => {
    if (event.target instanceof HTMLInputElement) return;
    at = event.clientX;
    element.setPointerCapture(event.pointerId);
    event.preventDefault();
  };
  element.onpointermove = (event) => {
    if (!element.hasPointerCapture(event.pointerId) || event.clientX === at) return;
    moved(event.clientX - at);
    at = event.clientX;
  };
}

// ── Squares to drag a dot in: the sky as a disc for a direction, a rectangle for a point.

/** @typedef {{element: SVGElement, show: (value: number[]) => void}} Pad */

const DEGREE = Math.PI / 180;

/** Where a direction is on the unit disc, right and up: the zenith in its middle, the horizon its rim.
 *  @param {number} azimuth @param {number} elevation degrees @returns {[number, number]} */
export function dotOf(azimuth, elevation) {
  const radius = 1 - clamp(elevation, 0, 90) / 90;
  return [radius * Math.sin(azimuth * DEGREE), radius * Math.cos(azimuth * DEGREE)];
}

/** The direction at a place of the unit disc, or at the nearest on its rim.
 *  @param {number} right @param {number} up @returns {[number, number]} azimuth, elevation in degrees */
export function directionAt(right, up) {
  const radius = Math.min(Math.hypot(right, up), 1);
  return [(Math.atan2(right, up) / DEGREE + 360) % 360, 90 * (1 - radius)];
}

/** The ranges of a point's two numbers.
 *  @param {Shown} one @returns {[number, number][]} */
const axesOf = (one) => [0, 1].map((part) => rangeOf(one, part) ?? [0, 1]);

/** A number in as many places as a pad can be pointed to.
 *  @param {number} number @param {[number, number]} range */
export function rounded(number, [low, high]) {
  const places = clamp(4 - Math.floor(Math.log10(high - low) + 1e-9), 1, 9);
  return clamp(+number.toFixed(places), low, high);
}

/** Make a pad; `changed` gets the new value of each drag.
 *  @param {Shown} one @param {(value: number[]) => void} changed @returns {Pad} */
function makePad(one, changed) {
  const sky = one.widget === "direction";
  const dot = svg("circle", { r: 0.11, class: "dot" });
  const lines = sky
    ? [1, 2 / 3, 1 / 3].map((r) => svg("circle", { r, class: "line" }))
    : ["x", "y"].map(() => svg("line", { class: "line" }));
  const ground = sky
    ? svg("circle", { r: 1, class: "ground" })
    : svg("rect", { x: -1, y: -1, width: 2, height: 2, class: "ground" });
  const ray = svg("line", { class: "ray" });
  const north = svg("path", { d: "M-.08-.72v-.2l.16.2v-.2", class: "line" });
  const element = /** @type {SVGElement} */ (
    svg(
      "svg",
      { viewBox: "-1.06 -1.06 2.12 2.12", class: "pad", "aria-hidden": "true" },
      ground,
      ...lines,
      ...(sky ? [north, ray] : []),
      dot,
    )
  );
  const point = (/** @type {PointerEvent} */ event) => {
    const box = element.getBoundingClientRect();
    const right = 2.12 * ((event.clientX - box.left) / box.width - 0.5),
      up = 2.12 * (0.5 - (event.clientY - box.top) / box.height);
    if (sky) return directionAt(right, up).map((degrees) => +degrees.toFixed(1));
    return axesOf(one).map((range, at) =>
      rounded(range[0] + ((at ? up : right) + 1) * 0.5 * (range[1] - range[0]), range),
    );
  };
  element.onpointerdown = (event) => {
    if (one.locked || event.button) return;
    event.preventDefault();
    element.setPointerCapture(event.pointerId);
    changed(point(event));
  };
  element.onpointermove = (event) => element.hasPointerCapture(event.pointerId) && changed(point(event));
  const show = (/** @type {number[]} */ value) => {
    const share = (/** @type {number} */ at) => {
      const [low, high] = axesOf(one)[at];
      return (2 * (value[at] - low)) / (high - low) - 1;
    };
    const [x, y] = sky ? dotOf(value[0], value[1]) : [share(0), share(1)];
    const place = (/** @type {Element} */ shape, /** @type {Object<string, number>} */ at) =>
      Object.entries(at).forEach(([name, number]) => shape.setAttribute(name, String(number)));
    place(dot, { cx: x, cy: -y });
    dot.classList.toggle("below", sky && value[1] < 0);
    if (sky) place(ray, { x2: x, y2: -y });
    else {
      place(lines[0], { x1: x, x2: x, y1: -1, y2: 1 });
      place(lines[1], { y1: -y, y2: -y, x1: -1, x2: 1 });
    }
  };
  return { element, show };
}

// ── A row of the panel for each parameter

/** @typedef {{element: Element, show: (value: any) => void}} Control */

/** What a row does.
 *  @typedef {object} Acts
 *  @property {Object<string, string>} words      of reset, azimuth, elevation, hex
 *  @property {(value: Value) => void} changed
 *  @property {() => void} reset
 *  @property {(down: boolean) => void} press     of a button */

/** A number, or the parts of a vector one below the other.
 *  @param {Shown} one @param {Acts} acts @param {string[]} [names] @param {string[]} [units]
 *  @returns {Control} */
function numbers(one, acts, names = partNames(one), units = []) {
  const box = make("div", { className: names.length ? "numbers named" : "numbers" });
  /** @type {number[]} */
  let now = [0];
  const largest = () => Math.max(...now.map(Math.abs));
  const lines = (names.length ? names : [""]).map((name, part) => {
    const changed = (/** @type {number} */ number) => {
      now = now.map((old, at) => (at === part ? number : old));
      acts.changed(names.length ? now : number);
    };
    const line = numberLine(one, { part, largest, changed, name, unit: units[part] });
    line.inputs.forEach((input) => { input.dataset.part = name; });
    box.append(line.element);
    return line;
  });
  const show = (/** @type {number | number[]} */ value) => {
    now = Array.isArray(value) ? [...value] : [value];
    lines.forEach((line, part) => line.show(now[part]));
  };
  return { element: box, show };
}

/** A pad, and its two numbers next to it.
 *  @param {Shown} one @param {Acts} acts @returns {Control} */
function withPad(one, acts) {
  const sky = one.widget === "direction", { azimuth, elevation } = acts.words;
  const named = sky ? [azimuth, elevation] : one.parts.length ? one.parts : ["x", "y"];
  const ranged = sky ? one : { ...one, ranges: axesOf(one), step: null };
  const pad = makePad(one, acts.changed);
  const fields = numbers(ranged, acts, named, sky ? ["°", "°"] : [" E", " N"]);
  const show = (/** @type {number[]} */ value) => {
    pad.show(value);
    fields.show(value);
  };
  return { element: make("div", { className: "with-pad" }, pad.element, fields.element), show };
}

/** A colour as it is shown: a well and its digits; an alpha is no light, and has a slider.
 *  @param {Shown} one @param {Acts} acts @returns {Control} */
function colour(one, { changed, words }) {
  const well = make("input", { type: "color" });
  const field = make("input", { type: "text", className: "hex", spellcheck: false, autocomplete: "off" });
  /** @type {number[]} */
  let now = [];
  const take = (/** @type {string} */ text) => {
    const found = fromHex(text, one.raw);
    if (found) changed([...found.slice(0, 3), ...now.slice(3)]);
    else show(now);
  };
  well.oninput = () => take(well.value);
  field.onchange = () => take(field.value);
  field.dataset.part = words.hex;
  /** @type {Shown} */
  const share = { ...one, type: "float", widget: "slider", ranges: [[0, 1]], unit: "" };
  const setAlpha = (/** @type {number} */ alpha) => changed([...now.slice(0, 3), alpha]);
  const alpha = numberLine(share, { part: 0, largest: () => 1, changed: setAlpha, name: "alpha" });
  alpha.inputs.forEach((input) => { input.dataset.part = "alpha"; });
  function show(/** @type {number[]} */ value) {
    now = value;
    well.value = field.value = toHex(value.slice(0, 3), one.raw);
    if (value.length > 3) alpha.show(value[3]);
  }
  const element = make("div", { className: "colour" }, well, field);
  if (one.type === "vec4") element.append(alpha.element);
  return { element, show };
}

/** @type {Object<string, (one: Shown, acts: Acts) => Control>} */
const KINDS = {
  direction: withPad,
  point: withPad,
  colour,
  checkbox(_, { changed }) {
    const input = make("input", { type: "checkbox" });
    input.onchange = () => changed(input.checked);
    return { element: input, show: (value) => { input.checked = value; } };
  },
  button(one, { press }) {
    const made = button(one.label, () => {}, { className: "press" });
    made.onclick = (event) => {
      if (event.detail) return; // a pointer's: its press and its release came before
      press(true);
      press(false);
    };
    made.onpointerdown = () => press(true);
    made.onpointerup = made.onpointerleave = made.onpointercancel = () => press(false);
    return { element: made, show: () => {} };
  },
  menu(one, { changed }) {
    const choices = one.choices.map((name, at) => make("option", { value: String(at) }, name));
    const input = make("select", {}, ...choices);
    input.onchange = () => changed(+input.value);
    return { element: input, show: (value) => { input.value = String(value); } };
  },
  file(_, { changed }) {
    const field = make("input", { type: "text", className: "file", autocomplete: "off" });
    field.onchange = () => changed(field.value);
    return { element: field, show: (value) => { field.value = String(value); } };
  },
};

/** Why rows are locked, before the first of several. @param {string} reason */
export const whyLocked = (reason) => make("p", { className: "note why-locked" }, reason);

/** Make a row. `show` puts a value into it and marks it as changed, or not; `said`: why it is locked stands
 *  somewhere else.
 *  @param {Shown} one @param {string} label @param {Acts} acts @param {boolean} [said] */
export function makeRow(one, label, acts, said = false) {
  const control = (KINDS[WIDGETS[one.widget].control] ?? numbers)(one, acts);
  const about = [one.description, one.locked].filter(Boolean).join(" ");
  const name = make("span", { className: "name" }, label);
  name.title = [about, one.path].filter(Boolean).join("\n");
  if (unitOf(one).length >= LONG) name.append(make("small", {}, ` ${one.unit}`));
  const back = button("×", acts.reset, { className: "reset", title: acts.words.reset });
  back.setAttribute("aria-label", `${acts.words.reset}: ${label}`);
  const note = make("p", { className: "note", hidden: !one.locked || said }, one.locked || one.description);
  const row = make("div", { className: `row is-${one.widget}`, role: "group", "aria-label": label });
  row.append(name, control.element, back, note);
  row.dataset.path = one.path;
  row.classList.toggle("locked", Boolean(one.locked));
  if (one.description && !one.locked) {
    name.classList.add("explained");
    name.onclick = () => { note.hidden = !note.hidden; };
  }
  /** @type {NodeListOf<HTMLInputElement>} */
  const inputs = row.querySelectorAll("input, select, .press");
  for (const input of inputs) {
    const { part } = input.dataset;
    if (!input.matches(".press")) input.setAttribute("aria-label", part ? `${label}, ${part}` : label);
    if (about) input.setAttribute("aria-description", about);
    input.disabled = Boolean(one.locked);
  }
  row.ondblclick = (event) => {
    const field = "input:not([type=range]), select, button";
    if (!one.locked && event.target instanceof Element && !event.target.matches(field)) acts.reset();
  };
  let typing = false; // what comes from elsewhere does not write over it
  row.addEventListener("input", ({ target }) => {
    typing = target instanceof HTMLInputElement && target.type === "text";
  });
  for (const end of ["change", "focusout"]) row.addEventListener(end, () => { typing = false; }, true);
  const show = (/** @type {Value} */ value, changed = false) => {
    if (!typing) control.show(value);
    row.classList.toggle("changed", changed);
    back.hidden = !changed;
  };
  return { element: row, show };
}
