// values.js -- the values of a sketch's parameters and its camera at a time: its own, keyframes', a user's.

/** @import { Camera, Leaf, Rule, Sketch, Track, Uniform, Value } from "./schema.js" */

// ── Angles that take a direction's azimuth until they are set: playground/sketch/follows.py.

/** Give what follows and is not set the azimuth that it follows, in place.
 *  @param {Rule[]} rules @param {Object<string, Value>} values by the paths of leaf parameters */
export function follow(rules, values) {
  for (const { targets, default: unset, direction, menu, choice } of rules) {
    if (values[targets[0]] !== unset || (menu && values[menu] !== choice)) continue;
    const azimuth = /** @type {number[]} */ (values[direction])[0];
    for (const path of targets) values[path] = azimuth;
  }
}

// ── The values of a sketch's parameters and its camera at a time

/** Every leaf pass of a sketch, those inside loops included.
 *  @param {import("./schema.js").Node[]} nodes @returns {Leaf[]} */
export const leavesOf = (nodes) => nodes.flatMap((node) => ("loop" in node ? leavesOf(node.body) : [node]));

/** @param {Value} a @param {Value} b */
export const isSame = (a, b) =>
  a === b || (Array.isArray(a) && Array.isArray(b) && a.length === b.length && a.every((n, k) => n === b[k]));

/** The value of every leaf parameter, by its path: the sketch's own, under those of keyframes, under those
 *  that a user has set; then what follows a direction.
 *  @param {Sketch} sketch @param {Object<string, Value>} given by path @param {number} time [s] */
export function valuesAt(sketch, given, time) {
  const found = { ...sketch.values };
  for (const track of sketch.tracks) {
    if (track.of !== "value") continue;
    const value = valueAt(track, time);
    for (const path of track.targets) found[path] = value;
  }
  Object.assign(found, given);
  follow(sketch.rules, found);
  return found;
}

/** The camera at a time: a user's, else the sketch's with what its keyframes say of it.
 *  @param {Sketch} sketch @param {Camera | null} given @param {number} time [s] @returns {Camera} */
export function cameraAt(sketch, given, time) {
  if (given) return given;
  const tracks = sketch.tracks.filter((track) => track.of === "camera");
  const at = (/** @type {Track} */ track) => valueAt(track, time);
  const found = Object.fromEntries(tracks.map((track) => [track.name, at(track)]));
  return { ...sketch.camera, ...found };
}

/** What a uniform gets for a value: of a menu with values of its own the chosen one.
 *  @param {Uniform} uniform @param {Value} value @returns {Value} */
export const givenTo = (uniform, value) =>
  uniform.values?.length && typeof value === "number" ? uniform.values[value] : value;

// ── What a track of keyframes says at a time, as playground/sketch/keyframes.py works it out.

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
