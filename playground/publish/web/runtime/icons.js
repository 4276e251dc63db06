// icons.js -- the pictures on buttons, drawn as lines.

import { make, svg } from "./dom.js";

/** Lines in a square of 16 by 16. */
const LINES = {
  full: "M2 6V2h4M10 2h4v4M14 10v4h-4M6 14H2v-4",
  save: "M8 2v8M4.5 7 8 10.500 11.500 7M2.500 13.500h11",
  view: "M3 7.500 8 3l5 4.500M4.500 7v6h7V7",
  keys: "M5.500 6a2.500 2.500 0 1 1 3.700 2.200C8.300 8.700 8 9.200 8 10M8 12.800v.4",
  theme: "M8 2a6 6 0 1 0 0 12V2ZM8 2a6 6 0 0 1 0 12",
  panel: "M2 3h12v10H2ZM10 3v10",
};

/** A button with a picture; its label is for those who do not see it, and a tooltip.
 *  @param {keyof typeof LINES} name @param {string} label @param {() => void} act */
export function iconButton(name, label, act) {
  const drawn = svg(
    "svg",
    { viewBox: "0 0 16 16", class: "icon", "aria-hidden": "true" },
    svg("path", { d: LINES[name] }),
  );
  return make(
    "button",
    { type: "button", className: `tool tool-${name}`, title: label, "aria-label": label, onclick: act },
    drawn,
  );
}
