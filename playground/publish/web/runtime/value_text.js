// value_text.js -- values as text, and back: as --set takes them, as a link holds them, as TOML has them.

import { fromHex, toHex } from "./colours.js";
import { general, isWhole, lengthOf, rangeOf } from "./numbers.js";
import { WIDGETS } from "./widgets.js";

/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Value} Value */

const MAX_METRES = 1e9; // [m] of the terrain

/** Six digits where they say the same, else all there are.
 *  @param {number} number */
export function digits(number) {
  const short = general(number, 6);
  return +short === number && Math.abs(number) < 1e6 ? short : String(number);
}

/** A value as the command line takes it, exactly.
 *  @param {Shown} one @param {Value} value @returns {string} */
export function write(one, value) {
  if (one.widget === "menu" && typeof value === "number") return one.choices[value] ?? String(value);
  if (!Array.isArray(value)) return typeof value === "number" ? digits(value) : String(value);
  if (one.widget === "colour") {
    const text = toHex(value, one.raw),
      there = fromHex(text, one.raw) ?? [];
    if (value.every((part, at) => Math.abs(part - (there[at] ?? 1)) <= 1e-7)) return text;
  }
  return value.map(digits).join(",");
}

/** Read a text as a value of a parameter; undefined where it is none, or lies outside its range.
 *  @param {Shown} one @param {string} text @returns {Value | undefined} */
export function read(one, text) {
  text = text.trim();
  if (one.widget === "file" || one.type === "sampler2D") return undefined;
  if (one.widget === "menu") {
    const at = one.choices.indexOf(text);
    if (at >= 0) return at;
    return /^\d{1,4}$/.test(text) && +text < one.choices.length ? +text : undefined;
  }
  if (one.type === "bool") {
    const word = text.toLowerCase();
    return (
      ["true", "on", "yes", "1"].includes(word) ||
      (["false", "off", "no", "0"].includes(word) ? false : undefined)
    );
  }
  const count = lengthOf(one.type);
  if (one.widget === "colour" && text.startsWith("#")) {
    const colour = fromHex(text, one.raw);
    return colour ? [...colour, 1].slice(0, count) : undefined;
  }
  const parts = text.split(",").map((part) => (part.trim() ? Number(part) : NaN));
  const value = count === 1 ? parts[0] : parts;
  return parts.length === count && fits(one, value) ? value : undefined;
}

/** What a number of a parameter may be; of the terrain more than its slider has.
 *  @param {Shown} one @param {number} part @returns {[number, number]} */
function limitsOf(one, part) {
  const { limits } = WIDGETS[one.widget];
  if (limits) return limits[part];
  if (one.path === "relief") return [0, MAX_METRES];
  if (one.path === "extent") return [Number.MIN_VALUE, MAX_METRES];
  const [low, high] = rangeOf(one, part) ?? [-Infinity, Infinity];
  const slack = 1e-6 * Math.max(Math.abs(low), Math.abs(high));
  if (!isWhole(one.type)) return low === -Infinity ? [low, high] : [low - slack, high + slack];
  const whole = one.type.startsWith("u") ? [0, 2 ** 32 - 1] : [-(2 ** 31), 2 ** 31 - 1];
  return [Math.max(low, whole[0]), Math.min(high, whole[1])];
}

/** Whether a value is one that a parameter takes, in its range.
 *  @param {Shown} one @param {unknown} value @returns {value is Value} */
export function fits(one, value) {
  if (one.type === "bool") return typeof value === "boolean";
  if (one.widget === "file" || one.type === "sampler2D") return typeof value === "string";
  if (one.widget === "menu") return Number.isInteger(value) && one.choices[Number(value)] !== undefined;
  const count = lengthOf(one.type), numbers = count === 1 ? [value] : Array.isArray(value) ? value : [];
  return numbers.length === count && numbers.every((number, part) => {
    if (typeof number !== "number" || !Number.isFinite(number)) return false;
    const [low, high] = limitsOf(one, part);
    return number >= low && number <= high && (!isWhole(one.type) || Number.isInteger(number));
  });
}

/** A value as TOML has it.
 *  @param {Shown} one @param {Value} value @returns {string} */
export function toml(one, value) {
  const text = write(one, value);
  if (one.type === "bool") return text;
  if (one.widget === "menu" || text.startsWith("#") || typeof value === "string") return quoted(text);
  if (one.widget === "direction" && Array.isArray(value)) {
    return `{ azimuth = ${point(value[0])}, elevation = ${point(value[1])} }`;
  }
  const number = isWhole(one.type) ? String : point;
  return Array.isArray(value) ? `[${value.map(number).join(", ")}]` : number(Number(value));
}

/** @param {number} number @returns {string} with a point, so that TOML reads it as a fraction */
const point = (number) => {
  const text = digits(number);
  return /[.e]/.test(text) ? text : `${text}.0`;
};

/** A basic string of TOML.
 *  @param {string} text */
export const quoted = (text) => JSON.stringify(text).replace(/\x7f/g, "\\u007f");

/** A word of a command that any shell takes as it is: in quotes where it holds more than plain letters.
 *  @param {string} word */
export const shellWord = (word) =>
  /^[\w.,=\-+/:]+$/.test(word) ? word : `"${word.replace(/[\\"$`]/g, "\\$&")}"`;
