// controls.js -- a row of the panel for each parameter: its label, what changes it, its reset.

import { fromHex, toHex } from "./colours.js";
import { button, make } from "./dom.js";
import { clamp, dragSpeed, isWhole, partNames, rangeOf, scaleOf, snapped, tidied, unitOf, written } from "./numbers.js";
import { axesOf, makePad } from "./pads.js";

/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Value} Value */
/** @typedef {{element: Element, show: (value: any) => void}} Control */
/** @typedef {(value: Value) => void} Changed */
/** What a row does.
 *  @typedef {{words: Object<string, string>, changed: Changed, reset: () => void, press: (down: boolean) => void}} Acts */

const STEPS = 1000; // of a slider without steps of its own
const SHORT = 4; // letters of a unit that is written after the number, and not after the label

/** A number with its slider, where it has a range; else one to drag.
 *  @param {Shown} one @param {number} part @param {() => number} largest @param {(number: number) => void} changed
 *  @param {string} [name] @param {string} [unit] */
function numberLine(one, part, largest, changed, name = "", unit = unitOf(one)) {
  const range = one.widget === "direction" ? [[-720, 720], [-90, 90]][part] : rangeOf(one, part);
  const scale = ["direction", "point"].includes(one.widget) ? null : scaleOf(one, part), whole = isWhole(one.type);
  const field = make("input", { type: "text", inputMode: "decimal", className: "number", autocomplete: "off" });
  const line = make("label", { className: "part" }, ...(name ? [make("span", { className: "part-name" }, name)] : []));
  let now = 0;
  const set = (/** @type {number} */ number) => {
    if (!Number.isFinite(number)) return show(now);
    const held = range ? clamp(number, range[0], range[1]) : number;
    changed(whole ? Math.round(held) : tidied(held));
  };
  const slider = scale && make("input", {
    type: "range", min: 0, max: 1,
    step: (one.step || (whole && scale.high - scale.low <= STEPS)) && one.widget !== "log_slider" ? (one.step || 1) / (scale.high - scale.low) : 1 / STEPS,
  });
  if (slider) {
    slider.oninput = () => changed(scale.value(+slider.value));
    line.append(slider);
  } else {
    line.classList.add("free");
    dragged(line, (by) => set(snapped(one, now + by * (range ? (range[1] - range[0]) / 500 : dragSpeed(one, largest())), part)));
  }
  field.onchange = () => set(Number(field.value.replace(",", ".").replace(/[^\d.eE+-]*$/, "") || NaN));
  field.onkeydown = (event) => {
    const way = { ArrowUp: 1, ArrowDown: -1 }[event.key];
    if (event.key === "Enter") field.select();
    if (!way) return;
    event.preventDefault();
    const step = one.step || (whole ? 1 : scale ? (scale.high - scale.low) / STEPS : dragSpeed(one, largest()));
    set(snapped(one, now + way * step * (event.shiftKey ? 10 : 1), part));
  };
  const show = (/** @type {number} */ number) => {
    now = number;
    const text = written(one, number, part);
    field.value = text + (unit.length < SHORT ? unit : "");
    if (!slider || !scale) return;
    slider.value = String(scale.share(number));
    slider.style.setProperty("--share", String(scale.share(number)));
    slider.setAttribute("aria-valuetext", text + unit);
  };
  line.append(field);
  return { line, show, inputs: slider ? [slider, field] : [field] };
}

/** Drag on a line's name or between: calls with the pixels gone since the last call.
 *  @param {HTMLElement} line @param {(by: number) => void} moved */
function dragged(line, moved) {
  line.onpointerdown = (event) => {
    if (event.target instanceof HTMLInputElement) return;
    line.setPointerCapture(event.pointerId);
    event.preventDefault();
  };
  line.onpointermove = (event) => line.hasPointerCapture(event.pointerId) && event.movementX && moved(event.movementX);
}

/** A number, or the parts of a vector one below the other.
 *  @param {Shown} one @param {Acts} acts @param {string[]} [names] @param {string[]} [units] @returns {Control} */
function numbers(one, { changed }, names = partNames(one), units = []) {
  const box = make("div", { className: names.length ? "numbers named" : "numbers" });
  /** @type {number[]} */
  let now = [0];
  const largest = () => Math.max(...now.map(Math.abs));
  const lines = (names.length ? names : [""]).map((name, part) => {
    const made = numberLine(one, part, largest, (number) => {
      now = now.map((old, at) => (at === part ? number : old));
      changed(names.length ? now : number);
    }, name, units[part]);
    made.inputs.forEach((input) => { input.dataset.part = name; });
    box.append(made.line);
    return made;
  });
  const show = (/** @type {number | number[]} */ value) => {
    now = Array.isArray(value) ? [...value] : [value];
    lines.forEach((line, part) => line.show(now[part]));
  };
  return { element: box, show };
}

/** A pad, and its two numbers next to it. @type {(one: Shown, acts: Acts) => Control} */
function withPad(one, acts) {
  const sky = one.widget === "direction", { words } = acts;
  const named = one.parts.length ? one.parts : sky ? [words.azimuth, words.elevation] : ["x", "y"];
  const ranged = sky ? one : { ...one, ranges: axesOf(one), step: null };
  const pad = makePad(one, acts.changed), fields = numbers(ranged, acts, named, sky ? ["°", "°"] : [" E", " N"]);
  const show = (/** @type {number[]} */ value) => { pad.show(value); fields.show(value); };
  return { element: make("div", { className: "with-pad" }, pad.element, fields.element), show };
}

/** @type {Object<string, (one: Shown, acts: Acts) => Control>} */
const KINDS = {
  direction: withPad,
  point: withPad,
  checkbox(_, { changed }) {
    const input = make("input", { type: "checkbox" });
    input.onchange = () => changed(input.checked);
    return { element: input, show: (value) => { input.checked = value; } };
  },
  button(one, { press }) {
    const made = button(one.label, () => {}, { className: "press" });
    made.onclick = (event) => { if (!event.detail) { press(true); press(false); } }; // by a key
    made.onpointerdown = () => press(true);
    for (const end of ["pointerup", "pointerleave", "pointercancel"]) made.addEventListener(end, () => press(false));
    return { element: made, show: () => {} };
  },
  menu(one, { changed }) {
    const input = make("select", {}, ...one.choices.map((name, at) => make("option", { value: String(at) }, name)));
    input.onchange = () => changed(+input.value);
    return { element: input, show: (value) => { input.value = String(value); } };
  },
  colour(one, { changed, words }) {
    const well = make("input", { type: "color" }), field = make("input", { type: "text", className: "hex", spellcheck: false, autocomplete: "off" });
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
    const alpha = numberLine({ ...one, widget: "slider", ranges: [[0, 1]], unit: "" }, 0, () => 1, (number) => changed([...now.slice(0, 3), number]), "alpha", "");
    alpha.inputs.forEach((input) => { input.dataset.part = "alpha"; });
    const show = (/** @type {number[]} */ value) => {
      now = value;
      well.value = field.value = toHex(value.slice(0, 3), one.raw);
      if (value.length > 3) alpha.show(value[3]);
    };
    const box = make("div", { className: "colour" }, well, field, ...(one.type === "vec4" ? [alpha.line] : []));
    return { element: box, show };
  },
  file() {
    const field = make("input", { type: "text", readOnly: true, className: "file" });
    return { element: field, show: (value) => { field.value = String(value); } };
  },
};

/** Make a row. `show` puts a value into it and marks it as changed, or not.
 *  @param {Shown} one @param {string} label @param {Acts} acts */
export function makeRow(one, label, acts) {
  const { words } = acts;
  const control = (KINDS[one.widget] ?? numbers)(one, acts);
  const about = [one.description, one.locked].filter(Boolean).join(" ");
  const name = make("span", { className: "name", title: [about, one.path].filter(Boolean).join("\n") }, label);
  if (unitOf(one).length >= SHORT) name.append(make("small", {}, ` ${one.unit}`));
  const back = button("×", acts.reset, { className: "reset", title: words.reset, "aria-label": `${words.reset}: ${label}` });
  const note = make("p", { className: "note", hidden: !one.locked }, one.locked || one.description);
  const row = make("div", { className: `row is-${one.widget}`, role: "group", "aria-label": label }, name, control.element, back, note);
  row.dataset.path = one.path;
  if (about) {
    name.classList.add("explained");
    name.onclick = () => { note.hidden = !note.hidden; };
  }
  for (const input of row.querySelectorAll("input, select, button.press")) {
    const part = input instanceof HTMLElement ? input.dataset.part : "";
    if (!input.matches(".press")) input.setAttribute("aria-label", part ? `${label}, ${part}` : label);
    if (about) input.setAttribute("aria-description", about);
    if (one.locked) Object.assign(input, { disabled: true });
  }
  row.classList.toggle("locked", Boolean(one.locked));
  let typing = false; // what comes from elsewhere does not write over it
  const types = (/** @type {Event} */ event) => event.target instanceof HTMLInputElement && event.target.type === "text";
  row.addEventListener("input", (event) => { typing = types(event); });
  for (const end of ["change", "focusout"]) row.addEventListener(end, () => { typing = false; }, true);
  row.ondblclick = (event) => {
    const field = event.target instanceof Element && event.target.matches("input:not([type=range]), select, button");
    if (!field && !one.locked) acts.reset();
  };
  const show = (/** @type {Value} */ value, changed = false) => {
    if (!typing) control.show(value);
    row.classList.toggle("changed", changed);
    back.hidden = !changed;
  };
  return { element: row, show };
}
