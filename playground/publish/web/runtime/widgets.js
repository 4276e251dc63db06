// widgets.js -- the table of widgets, which Python reads as well: see playground/shader/widgets.py.

import table from "../../../shader/widgets.json" with { type: "json" };

/** A row: what is true of every parameter with one widget; see `Kind` in playground/shader/widgets.py.
 *  @typedef {object} Kind
 *  @property {string} types                GLSL types that it may be given to, apart by blanks
 *  @property {string} control              what edits it: a row of KINDS in controls.js, or numbers
 *  @property {"range" | "range or nothing" | "ranges" | "raw or nothing" | "choices" | "sampling"} [takes]
 *  @property {"log"} [scale]               of the way over its range; linear without
 *  @property {[number, number]} [range]    of each number, where the brackets give none
 *  @property {[number, number][]} [spans]  of each part: what sliders go over, where no range is enforced
 *  @property {[number, number][]} [limits] of each part: what a value may be, where no range is enforced
 *  @property {string[]} [parts]            what a vector's components are called; x, y, z, w without
 *  @property {string} [unit] */

export const WIDGETS = /** @type {Object<string, Kind>} */ (/** @type {unknown} */ (table));

/** @param {string} widget @returns {boolean} whether equal ways over its range are equal ratios */
export const isLog = (widget) => WIDGETS[widget].scale === "log";
