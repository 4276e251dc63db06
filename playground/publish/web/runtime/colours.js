// colours.js -- colours between linear light and what is shown, as shader/colours.py has them.

import { clamp, roundEven } from "./numbers.js";

/** sRGB to linear light, one component (IEC 61966-2-1).
 *  @param {number} shown 0 to 1 */
export const toLinear = (shown) => (shown <= 0.04045 ? shown / 12.92 : ((shown + 0.055) / 1.055) ** 2.4);

/** Linear light to sRGB, one component.
 *  @param {number} light 0 to 1 */
export const toShown = (light) => (light <= 0.0031308 ? light * 12.92 : 1.055 * light ** (1 / 2.4) - 0.055);

/** Write a colour of three or four numbers as "#rrggbb" or "#rrggbbaa"; `raw`: it is as it is shown already.
 *  @param {number[]} colour @param {boolean} [raw] */
export function toHex(colour, raw) {
  const bytes = colour.map((part, at) => {
    const held = clamp(part);
    return roundEven(255 * (raw || at > 2 ? held : toShown(held)));
  });
  return `#${bytes.map((byte) => byte.toString(16).padStart(2, "0")).join("")}`;
}

/** Read "#rgb", "#rrggbb" or "#rrggbbaa" as linear numbers, or raw ones; null where it is none.
 *  @param {string} text @param {boolean} [raw] @returns {number[] | null} */
export function fromHex(text, raw) {
  let digits = /^#([0-9a-f]{3}|[0-9a-f]{6}|[0-9a-f]{8})$/i.exec(text.trim())?.[1];
  if (!digits) return null;
  if (digits.length === 3) digits = digits.replace(/./g, "$&$&");
  const parts = digits.match(/../g) ?? [];
  return parts.map((byte, at) => {
    const shown = parseInt(byte, 16) / 255;
    return raw || at > 2 ? shown : toLinear(shown);
  });
}
