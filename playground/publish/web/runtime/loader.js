// loader.js -- the entry of the one script that a page holds as it is: unpacks its style, its data and its
// runtime, and runs that. The page's policy names the hashes of all three scripts and styles.

import { unpackedText } from "./packed.js";

const byId = (/** @type {string} */ id) => /** @type {HTMLElement} */ (document.getElementById(id));

/** @param {"style" | "script"} kind @param {string} text @param {Object<string, string>} [attributes] */
function put(kind, text, attributes = {}) {
  document.head.append(Object.assign(document.createElement(kind), { textContent: text, ...attributes }));
}

/** The style, the data as JSON and the script; rejects where the file is damaged. */
async function parts() {
  const found = (await unpackedText(byId("playground-packed").textContent ?? "")).split("\0");
  if (found.length !== 3) throw new Error("three parts were expected");
  return found;
}

async function start() {
  if (!globalThis.DecompressionStream) return "playground-old";
  try {
    const [style, data, script] = await parts();
    put("style", style);
    put("script", data, { type: "application/json", id: "playground-page" });
    put("script", script);
    return "";
  } catch {
    return "playground-damaged";
  }
}

void start().then((sentence) => {
  if (sentence) byId(sentence).hidden = false;
});
