// between.js -- a slider's listed values, and those between them.

import { toHex } from "./colours.js";
import { clamp, isWhole, unitOf, written } from "./numbers.js";
import { write } from "./value_text.js";

/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Value} Value */

/** The value at a place among listed ones, from 0 to their count less one; linear between neighbours.
 *  @param {Pick<Shown, "type">} row @param {Value[]} values @param {number} place @returns {Value} */
export function valueAt(row, values, place) {
  const held = clamp(place, 0, values.length - 1), low = Math.floor(held), share = held - low;
  const from = values[low], to = values[Math.min(low + 1, values.length - 1)];
  if (share === 0) return from;
  const mixed = (/** @type {any} */ a, /** @type {any} */ b) => {
    const between = a + (b - a) * share;
    return isWhole(row.type) ? Math.round(between) : between;
  };
  if (!Array.isArray(from) || !Array.isArray(to)) return mixed(from, to);
  return from.map((part, at) => mixed(part, to[at]));
}

/** A value as a reader sees it: with its unit, in the places that suit the parameter; each part of a
 *  direction has its degrees, as in course/scenes.py.
 *  @param {Shown} row @param {Value} value @param {boolean} comma */
export function spelled(row, value, comma) {
  if (typeof value === "boolean") return write(row, value);
  if (row.widget === "colour" && Array.isArray(value)) return toHex(value, row.raw);
  const all = Array.isArray(value) ? value : [value];
  const unit = unitOf(row), degrees = unit === "°";
  const numbers = all.map((number, part) => {
    const text = written(row, Number(number), part);
    return (comma ? text.replaceAll(".", ",") : text) + (degrees ? unit : "");
  });
  return degrees ? numbers.join(", ") : numbers.join(comma ? "\u00a0; " : ", ") + unit;
}
