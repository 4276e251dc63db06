// expressions.js -- evaluates the expressions of a plan, exactly as playground/shader/expressions.py does.

import { arithmetic, bitLength, compared, float, floor, general, power } from "./exact.js";

/** @typedef {import("./schema.js").Expression} Expression */
/** @typedef {import("./exact.js").Exact} Exact */

/** What the names of an expression are. A whole number is a bigint or, of texels, a number; a number with a
 *  fraction a number, whole by chance or not: 1 / 3 is exact, 1.0 / 3 is not.
 *  @typedef {object} Names
 *  @property {(base: string, axis: number) => number | bigint} [size]     texels of a pass
 *  @property {(path: string) => number | bigint} [value]         what a uniform gets
 *  @property {(path: string, axis: number) => number | bigint} [picture]  texels of an image file
 *  @property {(kind: string, loop: string) => number} [counter]  "iteration" or "iterations" of a loop
 *  @property {(loop: string, name: string, axis: number) => number} [fed]  texels of what a loop feeds back
 *  @property {(name: string) => number | bigint | undefined} [name]       "iteration", "time", …  */

/** A mistake that a sentence can explain. `where`: its place, as "file:line", "" where it has none; undefined
 *  of a mistake in an expression that nothing has placed yet.
 *  @typedef {Error & {where: string | undefined}} PlanError */

const LIMIT = 2n ** 62n, MAX_BASE = 2n ** 31n;
const COUNTERS = ["iteration", "iterations"];

/** @param {string} message @param {string} [where] @returns {PlanError} */
export const planError = (message, where) =>
  Object.assign(new Error(message), { name: "PlanError", where });

/** Whether something thrown is a mistake of a sketch and not of this program.
 *  @param {unknown} error @returns {error is PlanError} */
export const isPlanError = (error) => error instanceof Error && error.name === "PlanError";

/** @type {Object<string, (order: number) => boolean>} */
const COMPARISONS = {
  "<": (order) => order < 0,
  "<=": (order) => order <= 0,
  ">": (order) => order > 0,
  ">=": (order) => order >= 0,
  "==": (order) => order === 0,
  "!=": (order) => order !== 0,
};

/** @type {Object<string, (...values: Exact[]) => Exact>} */
const FUNCTIONS = {
  log2: (value) => {
    const whole = floor(value);
    if (compared(value, whole) || whole < 1n || whole & (whole - 1n)) {
      throw planError(`log2(${general(float(value))}) is not whole: a power of two was expected`);
    }
    return BigInt(bitLength(whole) - 1);
  },
  bits: (value) => {
    const whole = floor(value);
    if (compared(value, whole) || whole < 0n) {
      throw planError(`bits(${general(float(value))}): a whole number from 0 was expected`);
    }
    return BigInt(bitLength(whole));
  },
  min: (...values) => values.reduce((least, value) => (compared(value, least) < 0 ? value : least)),
  max: (...values) => values.reduce((most, value) => (compared(value, most) > 0 ? value : most)),
  abs: (value) => {
    if (typeof value === "number") return Math.abs(value);
    return compared(value, 0n) < 0 ? arithmetic("*", value, -1n) : value;
  },
  floor,
  ceil: (value) => -floor(arithmetic("*", value, -1n)),
  "**": (base, exponent) => {
    if (typeof exponent !== "bigint") throw planError("the exponent of a power should be a whole number");
    const large = compared(base, MAX_BASE) > 0 || compared(base, -MAX_BASE) < 0;
    if (large || exponent > 62n || exponent < -62n) throw planError("a power may not be that large");
    if (!compared(base, 0n) && exponent < 0n) throw planError("division by zero");
    const found = power(base, exponent);
    if (typeof found !== "number" || Number.isFinite(found)) return found;
    throw planError("a power may not be that large");
  },
};

/** @param {Exact} value @param {string} text what the expression is called in messages @returns {Exact} */
function checked(value, text) {
  const within = compared(value, LIMIT) <= 0 && compared(value, -LIMIT) >= 0;
  if (within && (typeof value !== "object" || value.d <= LIMIT)) return value;
  throw planError(`'${text}' grows beyond 2**62`);
}

/** @param {Expression} expression @param {Names} names @param {string} text @returns {Exact} */
function valueOf(expression, names, text) {
  if (typeof expression === "number") {
    return checked(Number.isInteger(expression) ? BigInt(expression) : expression, text);
  }
  if (typeof expression === "string") {
    const found = names.name?.(expression);
    if (found === undefined) throw planError(`'${text}' names '${expression}', which is not known here`);
    return checked(found, text);
  }
  const [kind, first, second, third] = expression;
  if (kind === "text") return valueOf(second, names, first);
  if (kind === "float") return checked(first, text);
  if (kind === "size") return checked(BigInt(/** @type {any} */ (names).size(first, second)), text);
  if (kind === "picture") return checked(BigInt(/** @type {any} */ (names).picture(first, second)), text);
  if (kind === "value") return checked(/** @type {any} */ (names).value(first), text);
  if (COUNTERS.includes(kind)) return checked(BigInt(/** @type {any} */ (names).counter(kind, first)), text);
  if (kind === "fed") return checked(BigInt(/** @type {any} */ (names).fed(first, second, third)), text);
  if (kind === "if") {
    return valueOf(compared(valueOf(first, names, text), 0n) ? second : third, names, text);
  }
  const values = expression.slice(1).map((/** @type {Expression} */ inner) => valueOf(inner, names, text));
  if (kind in COMPARISONS) return COMPARISONS[kind](compared(values[0], values[1])) ? 1n : 0n;
  if (kind in FUNCTIONS) return checked(FUNCTIONS[kind](...values), text);
  if (["/", "//", "%"].includes(kind) && !compared(values[1], 0n)) throw planError("division by zero");
  return checked(arithmetic(kind, values[0], values[1]), text);
}

/** An expression as its author wrote it, where that is known.
 *  @param {Expression} expression */
export function textOf(expression) {
  if (!Array.isArray(expression)) return String(expression);
  return expression[0] === "text" ? expression[1] : JSON.stringify(expression);
}

/** Evaluate an expression to a whole number. Throws a `PlanError` in a sentence.
 *  @param {Expression} expression @param {Names} names @returns {bigint} */
export function integer(expression, names) {
  const value = valueOf(expression, names, textOf(expression));
  if (typeof value === "bigint") return value;
  if (typeof value === "number" && Number.isInteger(value)) return BigInt(value);
  throw planError(`'${textOf(expression)}' gives ${general(float(value))}; a whole number was expected`);
}

/** Evaluate an expression to a whole number, as a number. Throws a `PlanError` in a sentence.
 *  @param {Expression} expression @param {Names} names */
export const whole = (expression, names) => Number(integer(expression, names));

/** Evaluate an expression to a number, whole or not. Throws a `PlanError` in a sentence.
 *  @param {Expression} expression @param {Names} names */
export const number = (expression, names) => float(valueOf(expression, names, textOf(expression)));

/** What an expression asks its names for: kinds with their arguments, each once; nothing of loops.
 *  @param {Expression} expression @returns {string[][]} ["name", "time"], ["size", base] … */
export function namesIn(expression) {
  /** @type {Map<string, string[]>} */
  const found = new Map();
  /** @param {Expression} inner */
  const visit = (inner) => {
    const asked = typeof inner === "string" ? ["name", inner]
      : Array.isArray(inner) && ["size", "value", "picture"].includes(inner[0]) ? [inner[0], inner[1]] : null;
    if (Array.isArray(inner) && (COUNTERS.includes(inner[0]) || inner[0] === "fed")) return;
    if (asked) found.set(asked.join(" "), asked);
    else if (Array.isArray(inner)) inner.slice(inner[0] === "text" ? 2 : 1).forEach(visit);
  };
  visit(expression);
  return [...found.values()];
}
