// numbers.js -- a parameter's numbers: range, steps, places after the point, unit, as the window has them.

import table from "../../../shader/widgets.json" with { type: "json" };

/** @import { Shown, Value } from "./schema.js" */

// ── The table of widgets, which Python reads as well: see playground/shader/widgets.py.

/** A row: what is true of every parameter with one widget; see `Kind` in playground/shader/widgets.py.
 *  @typedef {object} Kind
 *  @property {string} types                GLSL types that it may be given to, apart by blanks
 *  @property {string} control              what edits it: a row of KINDS in controls.js, or numbers
 *  @property {"range" | "range or nothing" | "ranges" | "raw or nothing" | "choices" | "sampling"} [takes]
 *  @property {"log"} [scale]               of the way over its range; linear without
 *  @property {[number, number]} [range]    of each number, where the brackets give none
 *  @property {[number, number][]} [spans]  of each part: what sliders go over, where no range is enforced
 *  @property {[number, number][]} [limits] of each part: what a value may be, where no range is enforced
 *  @property {string[]} [parts]            what a vector's components are called; x, y, z, w without
 *  @property {string} [unit] */

export const WIDGETS = /** @type {Object<string, Kind>} */ (/** @type {unknown} */ (table));

/** @param {string} widget @returns {boolean} whether equal ways over its range are equal ratios */
export const isLog = (widget) => WIDGETS[widget].scale === "log";

// ── A parameter's numbers

/** @typedef {Pick<Shown, "type" | "widget" | "unit" | "parts" | "ranges" | "step">} Ranged */

/** A slider's way: `value` of a share of it from 0 to 1, `share` of a value.
 *  @typedef {object} Scale
 *  @property {number} low
 *  @property {number} high
 *  @property {(share: number) => number} value
 *  @property {(value: number) => number} share */

/** @param {string} type @returns {boolean} whether its components are integers */
export const isWhole = (type) => /^(u?int$|[iu]vec)/.test(type);

/** @param {string} type @returns {number} its components */
export const lengthOf = (type) => +(/^[iu]?vec([234])$/.exec(type)?.[1] ?? 1);

/** @param {number} number @param {number} [low] @param {number} [high] */
export const clamp = (number, low = 0, high = 1) => Math.min(Math.max(number, low), high);

/** Round halves to the even neighbour, as Python does.
 *  @param {number} number */
export function roundEven(number) {
  const low = Math.floor(number),
    rest = number - low;
  return rest < 0.5 || (rest === 0.5 && low % 2 === 0) ? low : low + 1;
}

/** What the parts of a vector are called; none of a scalar.
 *  @param {Ranged} one @returns {string[]} */
export function partNames(one) {
  if (lengthOf(one.type) === 1) return [];
  return one.parts.length ? one.parts : ["x", "y", "z", "w"].slice(0, lengthOf(one.type));
}

/** The range of one number of a parameter; null where it is unbounded.
 *  @param {Ranged} one @param {number} part @returns {[number, number] | null} */
export function rangeOf(one, part) {
  const [low, high] = one.ranges[part] ?? one.ranges[0] ?? [null, null];
  return low === null || high === null ? null : [low, high];
}

/** Places after the point that a step needs, 6 at most.
 *  @param {number} step */
function placesOf(step) {
  for (let places = 0; places < 7; places++) {
    const scaled = step * 10 ** places,
      near = roundEven(scaled);
    if (near && Math.abs(scaled - near) < 1e-6 * Math.max(scaled, 1)) return places;
  }
  return 6;
}

/** Places after the point that suit a parameter: of its step, or a thousandth of its range.
 *  @param {Ranged} one @param {number} [part] */
export function decimals(one, part = 0) {
  if (isWhole(one.type)) return 0;
  if (one.step) return placesOf(one.step);
  const range = rangeOf(one, part);
  const fine = !range ? 0 : isLog(one.widget) ? range[0] : (range[1] - range[0]) / 1000;
  return fine > 0 ? placesOf(10 ** Math.floor(Math.log10(fine) + 1e-9)) : 3;
}

const BEYOND = 40; // digits that tell a half from what is nearly one

/** Whether the digits that a number has beyond those that are written are exactly a half, to be rounded down.
 *  @param {string} exact its digits, BEYOND too many */
const isHalfDown = (exact) =>
  /^50*$/.test(exact.slice(-BEYOND)) && /[02468]\.?$/.test(exact.slice(0, -BEYOND));

/** Write a number with so many places after the point as C's %f does: halves go to the even digit.
 *  @param {number} number @param {number} places */
export function fixed(number, places) {
  const exact = number.toFixed(places + BEYOND);
  return isHalfDown(exact) ? exact.slice(0, -BEYOND).replace(/\.$/, "") : number.toFixed(places);
}

/** Write a number in so many digits as C's %g does.
 *  @param {number} number @param {number} digits */
export function general(number, digits) {
  if (!Number.isFinite(number)) return Number.isNaN(number) ? "nan" : number > 0 ? "inf" : "-inf";
  const [exact, there] = number.toExponential(digits - 1 + BEYOND).split("e");
  const [near, exponent] = number.toExponential(digits - 1).split("e");
  const [mantissa, power] = isHalfDown(exact) ? [exact.slice(0, -BEYOND), +there] : [near, +exponent];
  const tidy = (/** @type {string} */ text) => (text.includes(".") ? text.replace(/\.?0+$/, "") : text);
  if (power >= -4 && power < digits) return tidy(fixed(number, digits - 1 - power));
  return `${tidy(mantissa)}e${power < 0 ? "-" : "+"}${String(Math.abs(power)).padStart(2, "0")}`;
}

/** A number as the panel writes it, without its unit.
 *  @param {Ranged} one @param {number} number @param {number} [part] */
export function written(one, number, part = 0) {
  if (isWhole(one.type)) return String(Math.trunc(number));
  return isLog(one.widget) || !rangeOf(one, part)
    ? general(number, isLog(one.widget) ? 4 : 6)
    : fixed(number, decimals(one, part));
}

/** The unit as it follows a number: degrees close up, others after a space.
 *  @param {Ranged} one */
export function unitOf(one) {
  const unit = one.unit || (WIDGETS[one.widget].unit ?? "");
  if (unit === "degrees") return "°";
  return ["", "°", "%"].includes(unit) ? unit : ` ${unit}`;
}

/** The nearest value that lies in the range, whole steps from its lower end.
 *  @param {Ranged} one @param {number} number @param {number} [part] */
export function snapped(one, number, part = 0) {
  const range = rangeOf(one, part);
  if (one.step) {
    const start = range?.[0] ?? 0;
    number = start + roundEven((number - start) / one.step) * one.step;
    number = +number.toFixed(placesOf(one.step) + 2);
  }
  if (range) number = clamp(number, ...range);
  return isWhole(one.type) ? roundEven(number) : number;
}

/** The shortest decimal number that a shader cannot tell from it: 0.37 for 0.3700000048.
 *  @param {number} number */
export function tidied(number) {
  const single = Math.fround(number);
  if (!Number.isFinite(single)) return number;
  for (let digits = 1; digits < 10; digits++) {
    const short = +single.toPrecision(digits);
    if (Math.fround(short) === single) return short;
  }
  return single;
}

/** The way of a slider over one number; null where it has no range.
 *  @param {Ranged} one @param {number} [part] @returns {Scale | null} */
export function scaleOf(one, part = 0) {
  const range = rangeOf(one, part);
  if (!range || !(range[1] > range[0])) return null;
  const [low, high] = range,
    log = isLog(one.widget) && low > 0;
  const at = (/** @type {number} */ share) =>
    log ? low * (high / low) ** share : low + share * (high - low);
  return {
    low,
    high,
    value: (share) => {
      const exact = snapped(one, at(share), part);
      // In as many digits as the panel shows: what a thousandth of the way cannot tell apart is not said.
      return one.step || isWhole(one.type) ? exact : clamp(+written(one, exact, part), low, high);
    },
    share: (value) =>
      clamp(log ? Math.log(value / low) / Math.log(high / low) : (value - low) / (high - low)),
  };
}

/** How far a number without a range goes for one pixel of a drag; `largest` number of its vector.
 *  @param {Ranged} one @param {number} largest */
export function dragSpeed(one, largest) {
  const speed = one.step || Math.max(Math.abs(largest), 0.1) * 0.01;
  return isWhole(one.type) ? Math.max(speed, 0.2) : speed;
}

// ── Colours between linear light and what is shown, as shader/colours.py has them.

/** sRGB to linear light, one component (IEC 61966-2-1).
 *  @param {number} shown 0 to 1 */
export const toLinear = (shown) => (shown <= 0.04045 ? shown / 12.92 : ((shown + 0.055) / 1.055) ** 2.4);

/** Linear light to sRGB, one component.
 *  @param {number} light 0 to 1 */
export const toShown = (light) => (light <= 0.0031308 ? light * 12.92 : 1.055 * light ** (1 / 2.4) - 0.055);

/** Write a colour of three or four numbers as "#rrggbb" or "#rrggbbaa"; `raw`: it is as it is shown already.
 *  @param {number[]} colour @param {boolean} [raw] */
export function toHex(colour, raw) {
  const bytes = colour.map((part, at) => {
    const held = clamp(part);
    return roundEven(255 * (raw || at > 2 ? held : toShown(held)));
  });
  return `#${bytes.map((byte) => byte.toString(16).padStart(2, "0")).join("")}`;
}

/** Read "#rgb", "#rrggbb" or "#rrggbbaa" as linear numbers, or raw ones; null where it is none.
 *  @param {string} text @param {boolean} [raw] @returns {number[] | null} */
export function fromHex(text, raw) {
  let digits = /^#([0-9a-f]{3}|[0-9a-f]{6}|[0-9a-f]{8})$/i.exec(text.trim())?.[1];
  if (!digits) return null;
  if (digits.length === 3) digits = digits.replace(/./g, "$&$&");
  const parts = digits.match(/../g) ?? [];
  return parts.map((byte, at) => {
    const shown = parseInt(byte, 16) / 255;
    return raw || at > 2 ? shown : toLinear(shown);
  });
}

// ── Values as text, and back: as --set takes them, as a link holds them, as TOML has them.

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

// ── The values of a window's parameters as its JSON has them, and as rows show them.
//
// JSON has a menu's choice by its name, and a colour as "#rrggbb" where that is exact.

/** A parameter as GET parameters tells it: playground/sketch/assign.py.
 *  @typedef {Omit<import("./schema.js").Shown, "locked"> & {locked: boolean, file: any}} Told */

/** @param {Pick<Told, "widget" | "choices" | "raw">} one @param {any} told @returns {Value} */
export function shownValue({ widget, choices, raw }, told) {
  if (widget === "menu") return choices.indexOf(told); // -1: the menu shows none
  return widget === "colour" && typeof told === "string" ? fromHex(told, raw) ?? [0, 0, 0] : told;
}

/** @param {Pick<Told, "widget" | "choices">} one @param {any} value @returns {any} */
export const toldValue = ({ widget, choices }, value) => (widget === "menu" ? choices[value] : value);

/** Whether two values are the same. @param {Value} one @param {Value} other */
export const isSame = (one, other) => JSON.stringify(one) === JSON.stringify(other);
