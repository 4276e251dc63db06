// formulas.js -- works out the numbers of a plan that a page's controls change: see `Formula` in schema.js.

import { failure } from "./context.js";
import { general } from "./numbers.js";

/** @import { Step } from "./plan_nodes.js"
 *  @import { Formula } from "./schema.js" */

/** What names stand for, and operations on passes and loops: their formulas are not worked out before.
 *  @typedef {{name: (name: string) => number | undefined}
 *            & Record<string, (...parts: any[]) => any>} Names */

/** A mistake that a sentence can explain. `where`: its place, as "file:line", "" where it has none; undefined
 *  of a mistake in a formula that nothing has placed yet.
 *  @typedef {Error & {where: string | undefined}} PlanError */

const FRAME_RATE = 60;
const ROUNDED = 1e-12; // what a third, three times, may be off from a whole number, of that number

/** @param {string} message @param {string} [where] @returns {PlanError} */
export const planError = (message, where) =>
  Object.assign(new Error(message), { name: "PlanError", where });

/** Whether something thrown is a mistake of a sketch and not of this program.
 *  @param {unknown} error @returns {error is PlanError} */
export const isPlanError = (error) => error instanceof Error && error.name === "PlanError";

/** @param {number} number */
const divisor = (number) => {
  if (number === 0) throw planError("division by zero");
  return number;
};

/** The whole number that exact fractions would give, where rounding is all that parts a number from it.
 *  @param {number} number */
const exact = (number) => {
  const rounded = Math.round(number);
  return Math.abs(number - rounded) <= ROUNDED * Math.max(Math.abs(number), 1) ? rounded : number;
};

/** @type {Object<string, (...numbers: number[]) => number>} */
const OPERATIONS = {
  "+": (a, b) => exact(a + b),
  "-": (a, b) => exact(a - b),
  "*": (a, b) => exact(a * b),
  "/": (a, b) => exact(a / divisor(b)),
  "//": (a, b) => Math.floor(exact(a / divisor(b))),
  "%": (a, b) => exact(a - b * Math.floor(exact(a / divisor(b)))),
  "**": (a, b) => a ** b,
  "<": (a, b) => Number(a < b),
  "<=": (a, b) => Number(a <= b),
  ">": (a, b) => Number(a > b),
  ">=": (a, b) => Number(a >= b),
  "==": (a, b) => Number(a === b),
  "!=": (a, b) => Number(a !== b),
  bits: (number) => {
    if (Number.isInteger(number) && number >= 0) return number ? number.toString(2).length : 0;
    throw planError(`bits(${general(number, 6)}): a whole number from 0 was expected`);
  },
  log2: (number) => {
    if (number >= 1 && /^10*$/.test(number.toString(2))) return number.toString(2).length - 1;
    throw planError(`log2(${general(number, 6)}) is not whole: a power of two was expected`);
  },
  min: Math.min,
  max: Math.max,
  abs: Math.abs,
  floor: Math.floor,
  ceil: Math.ceil,
};

/** A formula as its author wrote it. @param {Formula} formula */
export const textOf = (formula) => (Array.isArray(formula) ? formula[1] : String(formula));

/** Work out a formula. Throws a `PlanError` in a sentence.
 *  @param {Formula} formula @param {Names} names @param {string} [text] what messages call it
 *  @returns {number} */
export function evaluated(formula, names, text = "") {
  if (typeof formula === "number") return formula;
  if (typeof formula === "string") {
    const found = names.name(formula);
    if (found === undefined) throw planError(`'${text}' names '${formula}', which is not known here`);
    return found;
  }
  const [kind, ...parts] = formula;
  if (kind === "text") return evaluated(parts[1], names, parts[0]);
  if (kind === "if") return evaluated(parts[evaluated(parts[0], names, text) ? 1 : 2], names, text);
  const operation = OPERATIONS[kind];
  return operation ? operation(...parts.map((part) => evaluated(part, names, text))) : names[kind](...parts);
}

/** Work out a formula that gives a whole number. Throws a `PlanError` in a sentence.
 *  @param {Formula} formula @param {Names} names */
export function whole(formula, names) {
  const found = exact(evaluated(formula, names));
  if (Number.isInteger(found)) return found;
  throw planError(`'${textOf(formula)}' gives ${general(found, 6)}; a whole number was expected`);
}

/** What names that follow the time [s] are. Frame n is at n / 60, however rounded: so many have run.
 *  @param {string} name @param {number} time */
export const clockOf = (name, time) =>
  name === "time" ? time : name === "frames" ? Math.floor(FRAME_RATE * time + 1e-6) + 1 : undefined;

/** What the formulas of a kernel's header name: its parameters, its size, clocks.
 *  @param {{size: [number, number], values: Object<string, import("./schema.js").Value>}} step
 *  @param {number} time [s] @param {Object<string, number>} [more] what comes first @returns {Names} */
export const headerNames = ({ size, values }, time, more = {}) => ({
  name: (name) => {
    if (Object.hasOwn(more, name)) return more[name];
    if (Object.hasOwn(values, name)) return Number(values[name]);
    return name === "size.x" ? size[0] : name === "size.y" ? size[1] : clockOf(name, time);
  },
});

// ── The lattice that a kernel fills ever more closely: playground/engine/lattice.py.

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
