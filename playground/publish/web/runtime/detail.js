// detail.js -- chooses what to draw of a mesh of which only a part is drawn: CHOOSERS of engine/lod.py.

import { geomipmap } from "./geomipmap.js";
import { morph } from "./morph.js";

/** @typedef {import("./visibility.js").View} View */
/** @typedef {import("./visibility.js").Table} Table */
/** @typedef {import("./tiles.js").Chosen} Chosen */

/** By mesh, the inputs of the draw whose texels the choice reads; its instances have an attribute `tile`.
 *  @type {Object<string, string[]>} */
export const CHOSEN_BY = { land: ["spans", "errors"] };

/** Chooses what to draw of a mesh; a full grid is drawn whole, once. `tables` downloads what it reads.
 *  @param {string} mesh @param {Object<string, any>} values @param {() => Object<string, Table>} tables
 *  @param {View} view @returns {Chosen} */
export function choose(mesh, values, tables, view) {
  if (!(mesh in CHOSEN_BY)) throw new Error(`nothing is chosen of mesh '${mesh}'`);
  if (values.detail === 0) return { runs: [["whole 0 0", 1]], places: new Float32Array(4) };
  const { spans, errors } = tables();
  return (values.detail === 1 ? geomipmap : morph)({ tolerance: values.tolerance }, { spans, errors }, view);
}
