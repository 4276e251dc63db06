// with_keyframes.js -- the add-on of pages with a sketch that has keyframes.

import { addOns } from "./addons.js";

// ── What a track of keyframes says at a time, as playground/sketch/keyframes.py works it out.

/** @typedef {import("./schema.js").Track} Track */
/** @typedef {import("./schema.js").Value} Value */

const CIRCLE = 360;

/** @param {Value} value @returns {number[]} */
const numbersOf = (value) => (Array.isArray(value) ? value : [Number(value)]);

/** Of two whole numbers as near the even one.
 *  @param {number} value */
const rounded = (value) => {
  const low = Math.floor(value), rest = value - low;
  return rest < 0.5 || (rest === 0.5 && low % 2 === 0) ? low : low + 1;
};

/** @param {number} angle @returns {number} from 0 to 360 degrees */
function withinCircle(angle) {
  const rest = angle % CIRCLE;
  return rest < 0 ? rest + CIRCLE : rest + 0;
}

/** Azimuths moved by 360 degrees, so that each is within 180 of the one before.
 *  @param {number[]} column */
function unwound(column) {
  const found = [column[0]];
  for (const value of column.slice(1)) {
    found.push(value - CIRCLE * rounded((value - found[found.length - 1]) / CIRCLE));
  }
  return found;
}

/** How fast a smooth track passes a keyframe; 0 where it does not pass smoothly. The weighted harmonic mean
 *  of the secants keeps it monotone (Fritsch and Butland 1984).
 *  @param {Track} track @param {number[]} column @param {number} index */
function slope({ times, eases }, column, index) {
  const passes = index > 0 && index < column.length - 1;
  if (!passes || eases[index - 1] !== "smooth" || eases[index] !== "smooth") return 0;
  const before = times[index] - times[index - 1], after = times[index + 1] - times[index];
  const coming = (column[index] - column[index - 1]) / before;
  const going = (column[index + 1] - column[index]) / after;
  if (coming * going <= 0) return 0;
  const share = (before + 2 * after) / (3 * (before + after));
  return (coming * going) / (share * going + (1 - share) * coming);
}

/** A number of a track between the keyframe `index` and the next.
 *  @param {Track} track @param {number[]} column @param {number} index @param {number} time */
function between(track, column, index, time) {
  const start = track.times[index], end = track.times[index + 1];
  const share = (time - start) / (end - start), low = column[index], high = column[index + 1];
  if (track.eases[index] === "linear") return low + share * (high - low);
  const there = (end - start) * slope(track, column, index + 1);
  const here = (end - start) * slope(track, column, index);
  // Hermite's cubic, from the two values and the two slopes.
  const rest = 1 - share;
  const value =
    low + share * share * (3 - 2 * share) * (high - low) + share * rest * (rest * here - share * there);
  return Math.min(Math.max(value, Math.min(low, high)), Math.max(low, high));
}

/** What a track says at a time [s]: before its first keyframe and after its last it stays.
 *  @param {Track} track @param {number} time @returns {Value} */
export function valueAt(track, time) {
  const { times, values, eases } = track;
  const later = times.findIndex((each) => each > time);
  const index = (later < 0 ? times.length : later) - 1;
  if (index < 0) return values[0];
  const here = values[index], stays = index === times.length - 1 || track.holds || eases[index] === "hold";
  if (stays || time === times[index]) return here;
  const found = numbersOf(here).map((_, which) => {
    const column = values.map((value) => numbersOf(value)[which]);
    if (!track.angles.includes(which)) return between(track, column, index, time);
    return withinCircle(between(track, unwound(column), index, time));
  });
  return Array.isArray(here) ? found : found[0];
}

// ── The add-on of pages with a sketch that has keyframes

addOns.keyframes = { valueAt };
