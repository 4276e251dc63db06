// loader.js -- the entry of the one script that a page holds as it is: unpacks its style, its data and its
// runtime, and runs that. The page's policy names the hashes of all three scripts and styles.

import { unpressed } from "./pressed.js";

const byId = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** @param {"style" | "script"} kind @param {string} text @param {Object<string, string>} [attributes] */
function put(kind, text, attributes = {}) {
  document.head.append(Object.assign(document.createElement(kind), { textContent: text, ...attributes }));
}

/** The style, the data as JSON and the script; throws where the file is damaged. */
function parts() {
  const found = unpressed(byId("playground-pressed").textContent ?? "").split("\0");
  if (found.length !== 3) throw new Error("three parts were expected");
  return found;
}

function start() {
  if (!globalThis.DecompressionStream) return "playground-old"; // images and elevation stay packed
  try {
    const [style, data, script] = parts();
    put("style", style);
    put("script", data, { type: "application/json", id: "playground-page" });
    put("script", script);
    return "";
  } catch {
    return "playground-damaged";
  }
}

const sentence = start();
if (sentence) byId(sentence).hidden = false;
