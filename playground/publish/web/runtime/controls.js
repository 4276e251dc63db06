// controls.js -- a row of the panel for each parameter: its label, what changes it, its reset.

import { fromHex, toHex } from "./colours.js";
import { button, make } from "./dom.js";
import { LONG, numberLine } from "./number_line.js";
import { partNames, unitOf } from "./numbers.js";
import { axesOf, makePad } from "./pads.js";
import { WIDGETS } from "./widgets.js";

/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Value} Value */
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
