// values.js -- the values of a sketch's parameters and its camera at a time: its own, keyframes', a user's.

import { needed } from "./addons.js";

// ── Angles that take a direction's azimuth until they are set: playground/sketch/follows.py.

/** @typedef {import("./schema.js").Rule} Rule */
/** @typedef {import("./schema.js").Value} Value */

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

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./schema.js").Kernel} Kernel */
/** @typedef {import("./schema.js").Uniform} Uniform */
/** @typedef {import("./schema.js").Camera} Camera */
/** @typedef {import("./schema.js").Leaf} Leaf */

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
    const value = needed("keyframes").valueAt(track, time);
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
  const at = (/** @type {import("./schema.js").Track} */ track) => needed("keyframes").valueAt(track, time);
  const found = Object.fromEntries(tracks.map((track) => [track.name, at(track)]));
  return { ...sketch.camera, ...found };
}

/** What a uniform gets for a value: of a menu with values of its own the chosen one.
 *  @param {Uniform} uniform @param {Value} value @returns {Value} */
export const givenTo = (uniform, value) =>
  uniform.values?.length && typeof value === "number" ? uniform.values[value] : value;
