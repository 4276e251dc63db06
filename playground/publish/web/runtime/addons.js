// addons.js -- what only some pages need of the runtime, put into one table by bundles of their own.
//
// A page carries those that its sketches need, before page.js: see playground/publish/web/addons.py. What needs one
// looks it up here. Those of a book and of a notebook are in their bundles.

/** @typedef {object} AddOns
 *  @property {typeof import("./edits.js")} [edits]          for texts that are edited in the page
 *  @property {typeof import("./plain.js") & typeof import("./usual.js")} [plain]   for other tools' shaders
 *  @property {typeof import("./keyframes.js")} [keyframes] */

/** @type {AddOns} */
export const addOns = (/** @type {any} */ (globalThis).playgroundAddOns ??= {});

/** Return an add-on that cannot be done without.
 *  @template {keyof AddOns} Name @param {Name} name @returns {NonNullable<AddOns[Name]>} */
export function needed(name) {
  const found = addOns[name];
  if (!found) throw new Error(`the runtime of this page was put together without '${name}'`);
  return /** @type {NonNullable<AddOns[Name]>} */ (found);
}
