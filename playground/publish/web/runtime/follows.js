// follows.js -- angles that take a direction's azimuth until they are set: playground/sketch/follows.py.

/** @typedef {import("./schema.js").Rule} Rule */
/** @typedef {import("./schema.js").Value} Value */

/** Give what follows and is not set the azimuth that it follows, in place.
 *  @param {Rule[]} rules @param {Object<string, Value>} values by the paths of leaf parameters */
export function follow(rules, values) {
  for (const { targets, default: unset, direction, menu, choice } of rules) {
    if (values[targets[0]] !== unset || (menu && values[menu] !== choice)) continue;
    const azimuth = /** @type {number[]} */ (values[direction])[0];
    for (const path of targets) values[path] = azimuth;
  }
}
