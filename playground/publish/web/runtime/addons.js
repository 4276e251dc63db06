// addons.js -- what only some pages need of the runtime, put into one table by bundles of their own.
//
// A page carries those that its sketches need, before page.js: see addons.py. What needs one looks it up
// here. Those of a book and of a notebook are in their bundles.

/** @typedef {typeof import("./with_editing.js")} Editing */
/** @typedef {typeof import("./with_plain.js")} Plain */

/** @typedef {object} AddOns
 *  @property {Pick<Editing, "tried" | "complaintsOf">} [edits]   for texts that are edited in the page
 *  @property {Pick<Plain, "createPlain" | "usualOf">} [plain]    for other tools' shaders
 *  @property {Pick<typeof import("./with_keyframes.js"), "valueAt">} [keyframes] */

/** @type {AddOns} */
export const addOns = (/** @type {any} */ (globalThis).playgroundAddOns ??= {});

/** Return an add-on that cannot be done without.
 *  @template {keyof AddOns} Name @param {Name} name @returns {NonNullable<AddOns[Name]>} */
export function needed(name) {
  const found = addOns[name];
  if (!found) throw new Error(`the runtime of this page was put together without '${name}'`);
  return /** @type {NonNullable<AddOns[Name]>} */ (found);
}
