// sizes.js -- texels of every pass of a sketch and counts of its loops: playground/engine/sizes.py.

import { integer, isPlanError, planError, textOf } from "./expressions.js";
import { givenTo, leavesOf, numberOf } from "./values.js";

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./schema.js").Value} Value */
/** @typedef {import("./schema.js").Source} Source */
/** @typedef {{path: string, output: string}} Ref */
/** @typedef {[number, number]} Size */
/** @typedef {import("./expressions.js").Names} Names */

export const MAX_SIDE = 16384;
export const MAX_REPEAT = 1_000_000;
const MAX_BOUND = 2 ** 31 - 1; // of a repeat that ends by itself: what GLSL counts
const MAX_COUNTED = 1024; // iterations of a loop of which each may have its own sizes: each is planned
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

/** The texels of passes, the counts of loops, and what expressions may name.
 *
 *  Where a size or a count inside a loop names its iteration, each iteration has sizes and counts of its
 *  own; from outside such a loop it is the last one. `sizeOf`, `sizeOfSource` and `countOf` throw a
 *  `PlanError` in a sentence; `iterations` calls `act` in each iteration of a loop, of which there is one at
 *  least, or once where all are the same.
 *  @typedef {{sizeOf: (path: string) => Size, sizeOfSource: (source: Source) => Size,
 *             countOf: (loop: string) => number, stepsOf: (loop: string, all: number) => number,
 *             iterations: (loop: string, act: () => void) => void}} Measured */

/** @param {Sketch} sketch @param {import("./schema.js").Shared} shared
 *  @param {{terrain: Size, frame: Size, time: number, values: Object<string, Value>,
 *           stopped: Object<string, number>}} now
 *  @returns {Measured} */
export function measure(sketch, shared, now) {
  /** @type {Object<string, Size>} */
  const bases = { "#terrain": now.terrain, "#frame": now.frame };
  /** @type {Map<string, Size>} */
  const sizes = new Map();
  /** @type {Map<string, number>} */
  const counts = new Map();
  /** @type {Map<string, [Source | null, Ref]>} what a loop's first iteration reads, and what it feeds back */
  const feedback = new Map();
  /** @type {string[]} */
  const open = [];
  /** The iteration of each counting loop around what is worked out, outermost first.
   *  @type {Map<string, number>} */
  let at = new Map();
  const uniforms = uniformsOf(sketch), { passes } = sketch;
  const isCounting = Object.values(passes).some((pass) => pass.counting);

  /** @param {import("./schema.js").Node[]} nodes */
  const addFeedback = (nodes) => nodes.forEach((node) => {
    if (!("loop" in node)) return;
    for (const [name, first, ref] of node.feedback) feedback.set(`${node.path} ${name}`, [first, ref]);
    addFeedback(node.body);
  });
  addFeedback(sketch.nodes);

  /** @type {Names} */
  const names = {
    size: (base, axis) => sizeAround(base)[axis],
    picture: (path, axis) => shared.images[String(now.values[path])].size[axis],
    value: (path) => {
      const uniform = uniforms.get(path);
      const found = uniform && numberOf(uniform.type, givenTo(uniform, now.values[path]));
      if (found === undefined) throw planError(`'${path}' is no number`);
      return found;
    },
    counter: (kind, loop) => (kind === "iteration" ? at.get(loop) ?? 0 : Math.max(countOf(loop), 1)),
    fed: (loop, name, axis) => sizeOfSource({ loop, name })[axis],
    name: (name) => (name === "time" ? now.time : name === "frames" ? BigInt(framesAt(now.time)) : undefined),
  };

  /** Work something out in other iterations. @template T @param {Map<string, number>} other
   *  @param {() => T} act @returns {T} */
  function within(other, act) {
    const before = at;
    at = other;
    try {
      return act();
    } finally {
      at = before;
    }
  }

  /** The iterations of the counting loops around a pass: of now, else their last.
   *  @param {string} path @param {boolean} [outside] without the pass itself
   *  @returns {Map<string, number>} */
  function around(path, outside = false) {
    /** @type {Map<string, number>} */
    const found = new Map();
    if (!isCounting) return found;
    const parts = path.split(".");
    for (let count = 1; count <= parts.length; count++) {
      const loop = parts.slice(0, count).join(".");
      if (!passes[loop]?.counting || (outside && loop === path)) continue;
      const last = () => Math.max(stepsOf(loop, countOf(loop)) - 1, 0);
      found.set(loop, at.get(loop) ?? within(found, last));
    }
    return found;
  }

  /** @param {string} loop @param {number} all */
  const stepsOf = (loop, all) => Math.min(now.stopped[loop] ?? all, all);

  /** @param {string} loop */
  function countOf(loop) {
    const outer = around(loop, true), key = [loop, ...outer.values()].join(" ");
    const before = counts.get(key);
    if (before !== undefined) return before;
    const { repeat, counting, where } = passes[loop];
    const found = within(outer, () => counted(/** @type {any} */ (repeat), nameOf(loop), where, names));
    if (counting && found > MAX_COUNTED) {
      const message = `repeat '${textOf(/** @type {any} */ (repeat))}' gives ${found}; 0 to ${MAX_COUNTED}`;
      const why = "were expected where a size or a repeat inside names the iteration";
      throw planError(`pass '${nameOf(loop)}': ${message} ${why}`, where);
    }
    counts.set(key, found);
    return found;
  }

  /** @param {string} loop @param {() => void} act */
  function iterations(loop, act) {
    if (!passes[loop].counting) return act();
    const count = Math.max(countOf(loop), 1);
    for (let number = 0; number < count; number++) within(new Map([...at, [loop, number]]), act);
  }

  /** @param {string} base a pass, or a base @returns {Size} */
  const sizeAround = (base) => (Object.hasOwn(bases, base) ? bases[base] : sizeOf(base));

  /** @param {string} path a pass, or a base @returns {Size} */
  function sizeOf(path) {
    if (Object.hasOwn(bases, path)) return bases[path];
    const now = around(path), key = [path, ...now.values()].join(" "), before = sizes.get(key);
    if (before) return before;
    const { base, size, own, where } = passes[path];
    if (open.includes(path)) {
      throw planError(`the sizes of ${open.join(" and ")} depend on each other`, where);
    }
    open.push(path);
    const found = within(now, () => {
      const around = own ?? sizeOf(base);
      return own || size ? checked(path, own ?? evaluated(path, size ?? []), where) : around;
    });
    open.pop();
    sizes.set(key, found);
    return found;
  }

  /** The size of what an input reads: of what is fed back, that of the iteration before.
   *  @param {Source} source @returns {Size} */
  function sizeOfSource(source) {
    if ("path" in source) return sizeOf(source.path);
    const [first, ref] = /** @type {[Source | null, Ref]} */ (feedback.get(`${source.loop} ${source.name}`));
    const now = around(source.loop), number = now.get(source.loop);
    if (number) return within(new Map([...now, [source.loop, number - 1]]), () => sizeOf(ref.path));
    return number === 0 && first ? sizeOfSource(first) : sizeOf(ref.path);
  }

  /** @param {string} path @param {import("./schema.js").Expression[]} size */
  function evaluated(path, size) {
    try {
      return size.map((side) => integer(side, names));
    } catch (error) {
      if (!isPlanError(error) || error.where !== undefined) throw error; // of another pass
      throw planError(`pass '${nameOf(path)}': size ${error.message}`, passes[path].where);
    }
  }

  /** @param {string} path @param {(number | bigint)[]} sides @param {string} where @returns {Size} */
  function checked(path, sides, where) {
    if (sides.every((side) => side >= 1 && side <= MAX_SIDE)) return [Number(sides[0]), Number(sides[1])];
    const when = at.size ? ` in iteration ${[...at.values()].pop()}` : "";
    const message = `size ${sides[0]} x ${sides[1]}${when}; 1 to ${MAX_SIDE} a side were expected`;
    throw planError(`pass '${nameOf(path)}': ${message}`, where);
  }

  return { sizeOf, sizeOfSource, countOf, stepsOf, iterations };
}

/** How many iterations a repeat gives; `name` is of what says so, and `where` a mistake is.
 *  @param {import("./schema.js").Expression} repeat @param {string} name @param {string} where
 *  @param {Names} known @param {boolean} [ends] whether it ends by itself */
export function counted(repeat, name, where, known, ends = false) {
  try {
    const count = integer(repeat, known);
    const limit = ends ? MAX_BOUND : MAX_REPEAT;
    if (count >= 0n && count <= limit) return Number(count);
    const message = `repeat '${textOf(repeat)}' gives ${count}; 0 to ${limit} were expected`;
    throw planError(`pass '${name}': ${message}`, where);
  } catch (error) {
    if (!isPlanError(error) || error.where !== undefined) throw error;
    throw planError(`pass '${name}': repeat ${error.message}`, where);
  }
}

/** The last name of a path.
 *  @param {string} path */
export const nameOf = (path) => path.slice(path.lastIndexOf(".") + 1);
