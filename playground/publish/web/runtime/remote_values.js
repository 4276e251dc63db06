// remote_values.js -- the values of a window's parameters as its JSON has them, and as rows show them.
//
// JSON has a menu's choice by its name, and a colour as "#rrggbb" where that is exact.

import { fromHex } from "./colours.js";

/** @typedef {import("./schema.js").Value} Value */
/** A parameter as GET parameters tells it: workbench/control/described.py.
 *  @typedef {Omit<import("./schema.js").Shown, "locked"> & {locked: boolean, file: any}} Told */

/** @param {Pick<Told, "widget" | "choices" | "raw">} one @param {any} told @returns {Value} */
export function shownValue({ widget, choices, raw }, told) {
  if (widget === "menu") return choices.indexOf(told); // -1: the menu shows none
  return widget === "colour" && typeof told === "string" ? fromHex(told, raw) ?? [0, 0, 0] : told;
}

/** @param {Pick<Told, "widget" | "choices">} one @param {any} value @returns {any} */
export const toldValue = ({ widget, choices }, value) => (widget === "menu" ? choices[value] : value);

/** Whether two values are the same. @param {Value} one @param {Value} other */
export const isSame = (one, other) => JSON.stringify(one) === JSON.stringify(other);
