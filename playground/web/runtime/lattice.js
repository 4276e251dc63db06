// lattice.js -- the lattice that a kernel fills ever more closely: playground/engine/lattice.py.

import { failure } from "./context.js";
import { planError, textOf, whole } from "./expressions.js";

/** @typedef {import("./schema.js").Kernel} Kernel */
/** @typedef {(name: string) => number | bigint | undefined} Names */

/** Whether the steps of a kernel fill a lattice. @param {Kernel} kernel */
export const fillsLattice = (kernel) => kernel.stride !== undefined;

/** The expressions of a kernel's header that a plan evaluates. @param {Kernel} kernel */
export const countsOf = ({ repeat, stride }) => [repeat, stride ?? 1];

/** How the texels that are known after `repeat` iterations of `all` are joined, as uniforms of
 *  fill_between.frag; null where nothing is. k_form 0: squares, 1: triangles, 2: squares of which only
 *  corners and centres are known: a stride that stays for two iterations is that of a lattice of which the
 *  first sets the squares' centres.
 *  @param {Kernel} kernel @param {import("./schema.js").Leaf} leaf @param {number} repeat
 *  @param {number} all @param {Names} own */
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
  return { k_stride: stride, k_form: stride === coming ? 2 : kernel.between === "triangles" ? 1 : 0 };
}

/** The power of two that the texels known after an iteration lie apart.
 *  @param {import("./plan_nodes.js").Step} step @param {number} iteration
 *  @param {(counts: Object<string, bigint>) => {name: Names}} namesOf what the header may name besides */
export function shiftAfter(step, iteration, namesOf) {
  const counts = { iteration: BigInt(iteration), iterations: BigInt(step.whole) };
  const stride = whole(step.kernel.stride ?? 1, namesOf(counts));
  if (stride < 1 || stride & (stride - 1)) {
    const where = `pass '${step.path}': stride gives ${stride} for iteration ${iteration}`;
    throw failure("sketch", `${where}; a power of two was expected`);
  }
  return 31 - Math.clz32(stride);
}
