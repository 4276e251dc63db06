// number_line.js -- one number of a parameter: a field, and a slider where it has a range, else a drag.

import { make } from "./dom.js";
import { clamp, dragSpeed, isWhole, rangeOf, scaleOf, snapped, tidied, unitOf, written } from "./numbers.js";
import { WIDGETS, isLog } from "./widgets.js";

/** @typedef {import("./schema.js").Shown} Shown */

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
export function numberLine(one, { part, largest, changed, name = "", unit = unitOf(one) }) {
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
