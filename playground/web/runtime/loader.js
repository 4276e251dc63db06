// loader.js -- the entry of the one script that a page holds as it is: unpacks its style, its data and its
// runtime, and runs that. The page's policy names the hashes of all three scripts and styles.

import { unpressed } from "./pressed.js";

const byId = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** @param {"style" | "script"} kind @param {string} text @param {Object<string, string>} [attributes] */
function put(kind, text, attributes = {}) {
  document.head.append(Object.assign(document.createElement(kind), { textContent: text, ...attributes }));
}

try {
  if (!globalThis.DecompressionStream) throw new Error("images and elevation could not be unpacked");
  const [style, data, script] = unpressed(byId("playground-pressed").textContent ?? "").split("\0");
  put("style", style);
  put("script", data, { type: "application/json", id: "playground-page" });
  put("script", script);
} catch {
  byId("playground-old").hidden = false;
}
