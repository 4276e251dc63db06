// counts.js -- what a kernel's header counts with: its own names, and how a stopped run's texels are joined.

import { planError, textOf, whole } from "./expressions.js";
import { framesAt } from "./sizes.js";
import { numberOf } from "./values.js";

/** @typedef {import("./schema.js").Kernel} Kernel */
/** @typedef {import("./schema.js").Leaf} Leaf */
/** @typedef {import("./schema.js").Value} Value */

/** What the expressions of a kernel's header name.
 *  @param {Kernel} kernel @param {[number, number]} size @param {Object<string, Value>} values
 *  @param {number} time @param {Object<string, bigint>} [more] */
export function ownNames(kernel, size, values, time, more = {}) {
  const types = new Map(kernel.parameters.map((uniform) => [uniform.name, uniform.type]));
  return (/** @type {string} */ name) => {
    if (Object.hasOwn(more, name)) return more[name];
    if (types.has(name)) return numberOf(/** @type {string} */ (types.get(name)), values[name]);
    if (name === "size.x" || name === "size.y") return BigInt(size[name === "size.x" ? 0 : 1]);
    return name === "time" ? time : name === "frames" ? BigInt(framesAt(time)) : undefined;
  };
}

/** How the texels that are known after `repeat` iterations of `all` are joined; null where nothing is. A
 *  stride that stays for two iterations is that of a lattice of which the first sets the squares' centres.
 *  @param {Kernel} kernel @param {Leaf} leaf @param {number} repeat @param {number} all
 *  @param {(name: string) => number | bigint | undefined} own */
export function betweenOf(kernel, leaf, repeat, all, own) {
  const begins = leaf.inputs.some(([name, source]) => source && name in kernel.initial);
  if (!kernel.between || !(repeat > 0 && repeat < all) || begins) return null;
  const [stride, coming] = [repeat - 1, repeat].map((iteration) => {
    const counts = { iteration: BigInt(iteration), iterations: BigInt(all) };
    const name = (/** @type {string} */ name) => counts[/** @type {"iteration"} */ (name)] ?? own(name);
    return whole(kernel.stride ?? 1, { name });
  });
  if (stride < 1) {
    const message = `stride '${textOf(kernel.stride ?? 1)}' gives ${stride} for iteration ${repeat - 1}`;
    throw planError(`pass '${leaf.path}': ${message}`, kernel.file);
  }
  const form = stride === coming ? 2 : kernel.between === "triangles" ? 1 : 0;
  return { stride, form: /** @type {0 | 1 | 2} */ (form) };
}
