// counts.js -- what a kernel's header counts with: its own names.

import { framesAt } from "./sizes.js";
import { numberOf } from "./values.js";

/** @typedef {import("./schema.js").Kernel} Kernel */
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
