// accepts.js -- the sizes that a kernel takes: playground/shader/expressions.py.

import { integer, isPlanError } from "./expressions.js";

/** @typedef {import("./schema.js").Accepted} Accepted */

/** @type {WeakMap<Accepted, number[][]>} */
const known = new WeakMap();

/** The sizes that are accepted along x and along y, smallest first.
 *  @param {Accepted} accepted @returns {number[][]} one list where only squares are accepted, else two */
export function acceptedSizes(accepted) {
  let found = known.get(accepted);
  if (!found) {
    found = accepted.map((forms) => {
      const all = new Set(forms.flatMap(([expression, most]) => valuesOf(expression, most)));
      return [...all].sort((a, b) => a - b);
    });
    known.set(accepted, found);
  }
  return found;
}

/** @param {import("./schema.js").Expression} expression of n, or m @param {number} most */
function valuesOf(expression, most) {
  const found = [];
  for (let n = 0n; n <= BigInt(most); n++) {
    try {
      const value = Number(integer(expression, { name: () => n }));
      if (value > most) break;
      if (value >= 1) found.push(value);
    } catch (error) {
      if (!isPlanError(error)) throw error; // not whole for this n, as 2 ** (n - 1) for 0
    }
  }
  return found;
}

/** @param {Accepted} accepted @param {[number, number]} size */
export function isAccepted(accepted, size) {
  const axes = acceptedSizes(accepted);
  if (axes.length === 1 && size[0] !== size[1]) return false;
  return axes[0].includes(size[0]) && axes[axes.length - 1].includes(size[1]);
}

/** The accepted sizes just below and just above one, or the only one there is.
 *  @param {Accepted} accepted @param {[number, number]} size @returns {[number, number][]} */
export function nearestAccepted(accepted, size) {
  const lists = acceptedSizes(accepted), largest = Math.max(...size);
  const [xs, ys] = [lists[0], lists[lists.length - 1]];
  const [x, y] = lists.length === 1 ? [largest, largest] : size;
  /** @param {number[]} all @param {number} side */
  const below = (all, side) => all.filter((each) => each <= side).pop() ?? all[0];
  /** @param {number[]} all @param {number} side */
  const above = (all, side) => all.find((each) => each >= side) ?? all[all.length - 1];
  /** @type {[number, number][]} */
  const found = [[below(xs, x), below(ys, y)], [above(xs, x), above(ys, y)]];
  return String(found[0]) === String(found[1]) ? found.slice(1) : found;
}
