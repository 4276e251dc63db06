// accepts.js -- the sizes that a kernel takes: playground/shader/expressions.py.

/** @typedef {[number, number, number][]} Runs */

/** The accepted sizes just below and just above one: itself alone where it is accepted.
 *  @param {import("./schema.js").Accepted} accepted @param {[number, number]} size
 *  @returns {[number, number][]} */
export function nearestAccepted(accepted, size) {
  const [xs, ys = xs] = accepted, longest = Math.max(...size);
  const [x, y] = accepted.length === 1 ? [longest, longest] : size;
  const [low, high] = [[below(xs, x), below(ys, y)], [above(xs, x), above(ys, y)]];
  const found = /** @type {[number, number][]} */ ([low, high]);
  return String(low) === String(high) ? found.slice(1) : found;
}

/** The largest number of runs that is not above a side, else the smallest there is.
 *  @param {Runs} runs @param {number} side */
function below(runs, side) {
  const run = runs.filter(([first]) => first <= side).pop();
  if (!run) return runs[0][0];
  const [first, last, step] = run;
  return first + Math.floor((Math.min(side, last) - first) / step) * step;
}

/** The smallest number of runs that is not below a side, else the largest there is.
 *  @param {Runs} runs @param {number} side */
function above(runs, side) {
  const run = runs.find(([, last]) => last >= side);
  if (!run) return runs[runs.length - 1][1];
  const [first, , step] = run;
  return first + Math.ceil(Math.max(side - first, 0) / step) * step;
}
