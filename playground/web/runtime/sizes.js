// sizes.js -- texels of every pass of a sketch, for one terrain and one picture.

import { integer, isPlanError, planError } from "./expressions.js";
import { givenTo, leavesOf, numberOf } from "./values.js";

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./schema.js").Value} Value */
/** @typedef {[number, number]} Size */
/** @typedef {import("./expressions.js").Names} Names */

export const LARGEST_SIDE = 16384;
const FRAME_RATE = 60;

/** How many frames have run at a time [s], that of second 0 included: n / 60 is frame n, however rounded.
 *  @param {number} time */
export const framesAt = (time) => Math.floor(FRAME_RATE * time + 1e-6) + 1;

/** The uniform whose value is at each path.
 *  @type {WeakMap<Sketch, Map<string, import("./schema.js").Uniform>>} */
const known = new WeakMap();

/** @param {Sketch} sketch */
function uniformsOf(sketch) {
  let found = known.get(sketch);
  if (!found) {
    found = new Map();
    for (const leaf of leavesOf(sketch.nodes)) {
      for (const uniform of sketch.kernels[leaf.kernel].parameters) {
        const path = leaf.values[uniform.name];
        if (path !== undefined && !found.has(path)) found.set(path, uniform);
      }
    }
    known.set(sketch, found);
  }
  return found;
}

/** What expressions may name: texels of passes, values, image files, clocks.
 *  @param {Sketch} sketch @param {import("./schema.js").Shared} shared
 *  @param {{terrain: Size, frame: Size, time: number, values: Object<string, Value>}} now
 *  @returns {{sizeOf: (path: string) => Size, names: Names}} `sizeOf` throws a `PlanError` in a sentence */
export function measure(sketch, shared, now) {
  /** @type {Map<string, Size>} */
  const sizes = new Map([["#terrain", now.terrain], ["#frame", now.frame]]);
  /** @type {string[]} */
  const open = [];
  const uniforms = uniformsOf(sketch);

  /** @type {Names} */
  const names = {
    size: (base, axis) => sizeOf(base)[axis],
    picture: (path, axis) => shared.images[String(now.values[path])].size[axis],
    value: (path) => {
      const uniform = uniforms.get(path);
      const found = uniform && numberOf(uniform.type, givenTo(uniform, now.values[path]));
      if (found === undefined) throw planError(`'${path}' is no number`);
      return found;
    },
    name: (name) => (name === "time" ? now.time : name === "frames" ? BigInt(framesAt(now.time)) : undefined),
  };

  /** @param {string} path @returns {Size} */
  function sizeOf(path) {
    const before = sizes.get(path);
    if (before) return before;
    const { base, size, own, where } = sketch.passes[path];
    if (open.includes(path)) {
      throw planError(`the sizes of ${open.join(" and ")} depend on each other`, where);
    }
    open.push(path);
    let found = own ?? sizeOf(base);
    if (own || size) found = checked(path, own ?? evaluated(path, size ?? []), where);
    open.pop();
    sizes.set(path, found);
    return found;
  }

  /** @param {string} path @param {import("./schema.js").Expression[]} size */
  function evaluated(path, size) {
    try {
      return size.map((side) => integer(side, names));
    } catch (error) {
      if (!isPlanError(error) || error.where !== undefined) throw error; // of another pass
      throw planError(`pass '${nameOf(path)}': size ${error.message}`, sketch.passes[path].where);
    }
  }

  return { sizeOf, names };
}

/** The last name of a path.
 *  @param {string} path */
export const nameOf = (path) => path.slice(path.lastIndexOf(".") + 1);

/** @param {string} path @param {(number | bigint)[]} sides @param {string} where @returns {Size} */
function checked(path, sides, where) {
  if (sides.every((side) => side >= 1 && side <= LARGEST_SIDE)) return [Number(sides[0]), Number(sides[1])];
  const message = `size ${sides[0]} x ${sides[1]}; 1 to ${LARGEST_SIDE} a side were expected`;
  throw planError(`pass '${nameOf(path)}': ${message}`, where);
}
