// lattice.js -- the lattice that a kernel fills ever more closely: playground/engine/lattice.py.

import { failure } from "./context.js";
import { headerNames, planError, textOf, whole } from "./formulas.js";

/** @typedef {import("./plan_nodes.js").Step} Step */

/** The texels from one node of the lattice that an iteration fills to the next.
 *  @param {Omit<Step, "between">} step @param {number} iteration @param {number} time [s] */
const strideAt = (step, iteration, time) =>
  whole(step.kernel.stride ?? 1, headerNames(step, time, { iteration, iterations: step.total }));

/** How the texels that a stopped step knows are joined, as uniforms of fill_between.frag; null where nothing
 *  is. k_form 0: squares, 1: triangles, 2: squares of which only corners and centres are known: a stride that
 *  stays for two iterations is that of a lattice of which the first sets the squares' centres.
 *  @param {Omit<Step, "between">} step @param {number} time [s] */
export function betweenOf(step, time) {
  const { kernel, path, repeat, inputs } = step;
  const begins = inputs.some(([name, source]) => source && name in kernel.initial);
  if (!kernel.between || !(repeat > 0 && repeat < step.total) || begins) return null;
  const stride = strideAt(step, repeat - 1, time);
  if (stride < 1) {
    const message = `stride '${textOf(kernel.stride ?? 1)}' gives ${stride} for iteration ${repeat - 1}`;
    throw planError(`pass '${path}': ${message}`, kernel.file);
  }
  const isHalf = stride === strideAt(step, repeat, time);
  return { k_stride: stride, k_form: isHalf ? 2 : kernel.between === "triangles" ? 1 : 0 };
}

/** The power of two that the texels known after an iteration lie apart.
 *  @param {Step} step @param {number} iteration @param {number} time [s] */
export function shiftAfter(step, iteration, time) {
  const stride = strideAt(step, iteration, time);
  if (stride < 1 || stride & (stride - 1)) {
    const where = `pass '${step.path}': stride gives ${stride} for iteration ${iteration}`;
    throw failure("sketch", `${where}; a power of two was expected`);
  }
  return 31 - Math.clz32(stride);
}
