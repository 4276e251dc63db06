// numbers.js -- a parameter's numbers: range, steps, places after the point, unit, as the window has them.

import { WIDGETS, isLog } from "./widgets.js";

/** @typedef {import("./schema.js").Shown} Shown */
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
