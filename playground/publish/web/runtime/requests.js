// requests.js -- what a plan is made for besides its sketch, and checks of it: engine/plan.py.

import { planError } from "./formulas.js";
import { isSame, leavesOf } from "./values.js";

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./schema.js").Value} Value */
/** @typedef {import("./schema.js").Camera} Camera */
/** @typedef {[number, number]} Size */

/** @typedef {{size: Size, extent: Size, relief: number, base_elevation: number}} Metres */

/** What a plan is made for: `values` by path over the sketch's, `steps` repeats that are stopped early,
 *  `map` a texture shown from above in place of the view, with values of the map's own parameters.
 *  @typedef {object} State
 *  @property {Object<string, Value>} [values]
 *  @property {{size: Size, extent: Size | null, relief: number, base_elevation: number}} [terrain]
 *      extent null: as the sketch has it, or as its size is where nothing says it
 *  @property {Camera | null} [camera]          null: as the sketch and its keyframes have it
 *  @property {Size} [frame]                    pixels
 *  @property {number} [time]                   seconds
 *  @property {Object<string, number>} [steps]  iterations after which a repeat stops, by path
 *  @property {boolean} [interpolated]          what a stopped repeat has not computed is filled in
 *  @property {{path: string, output: string, values: Object<string, Value>} | null} [map]
 *  @property {import("./usual.js").Live} [live]  what the pointer and the clock of the page say */

export const MAX_SIDE = 16384;

/** @param {number} time */
export function checkedTime(time) {
  if (!Number.isFinite(time)) throw planError(`time ${time}: expected a number of seconds`, "");
  return time;
}

/** @param {[number, number]} frame @returns {[number, number]} */
export function checkedFrame([width, height]) {
  const fits = [width, height].every((side) => Number.isInteger(side) && side >= 1 && side <= MAX_SIDE);
  if (fits) return [width, height];
  throw planError(`a picture of ${width} x ${height} pixels; 1 to ${MAX_SIDE} a side were expected`, "");
}

/** @param {Sketch} sketch @param {State} state @returns {Metres} */
export function terrainOf(sketch, state) {
  const { size, extent, relief, base_elevation } = { ...sketch.terrain, ...state.terrain };
  /** @param {boolean} fits @param {string} name @param {number | number[]} value @param {string} wanted */
  const check = (fits, name, value, wanted) => {
    if (!fits) throw planError(`${name} = '${[value].flat().join("x")}': expected ${wanted}`, "");
  };
  const sides = size.every((side) => Number.isInteger(side) && side >= 1 && side <= MAX_SIDE);
  check(sides, "size", size, `1 to ${MAX_SIDE} texels a side, as 513 or 513x257`);
  const own = sketch.terrain, unset = !extent || isSame(extent, own.extent);
  const metres = !unset ? extent : own.extentFollows ? withSides(own.extent[0], size) : own.extent;
  const above0 = metres.every((side) => side > 0 && side < 1e9);
  check(above0, "extent", metres, "metres above 0, as 10240 or 10240x8000");
  check(relief >= 0 && relief < 1e9, "relief", relief, "a number of metres, 0 or more");
  check(Math.abs(base_elevation) < 1e9, "base_elevation", base_elevation, "a number of metres");
  return { size: [size[0], size[1]], extent: [metres[0], metres[1]], relief, base_elevation };
}

/** The extent of a terrain whose sides are to each other as its texels are.
 *  @param {number} wide [m] @param {Size} size @returns {Size} */
const withSides = (wide, size) => [wide, wide * ((size[1] - 1) / Math.max(size[0] - 1, 1) || 1)];

/** Return after how many iterations repeats stop, by the paths of what repeats.
 *  @param {Sketch} sketch @param {Object<string, number>} steps */
export function checkedSteps(sketch, steps) {
  const repeated = repeatedPaths(sketch);
  /** @type {Object<string, number>} */
  const found = {};
  for (const [path, count] of Object.entries(steps)) {
    const inside = repeated.filter((name) => name.startsWith(`${path}.`));
    const name = repeated.includes(path) ? path : inside.length === 1 ? inside[0] : "";
    if (!name) throw planError(`steps: no repeated pass '${path}' in sketch ${sketch.name}`, "");
    if (!Number.isInteger(count) || count < 0) {
      throw planError(`steps: '${path}' stops after ${count} steps; expected a whole number from 0`, "");
    }
    found[name] = count;
  }
  return found;
}

/** @param {Sketch} sketch */
function repeatedPaths(sketch) {
  /** @param {import("./schema.js").Node[]} nodes @returns {string[]} */
  const loops = (nodes) => nodes.flatMap((node) => ("loop" in node ? [node.path, ...loops(node.body)] : []));
  const kernels = leavesOf(sketch.nodes).filter((leaf) => sketch.kernels[leaf.kernel].repeat !== 1);
  return [...new Set([...loops(sketch.nodes), ...kernels.map((leaf) => leaf.path)])];
}
