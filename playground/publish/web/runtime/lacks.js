// lacks.js -- why a picture stands still, as a sentence.

import { fill } from "./words.js";

/** What an error means to who looks at a picture.
 *  @param {unknown} error  one of the engine's, with its code, or any other
 *  @param {Object<string, string>} words  of the editor
 *  @param {string} [otherwise]  with a place for the reason, where the code has no words of its own */
export function lackOf(error, words, otherwise = words.lacks) {
  const { code = "", sentence = "", message = "" } = /** @type {Object<string, string>} */ (error ?? {});
  if (code === "no-webgl2") return words.noWebGL;
  if (code === "no-float-targets") return words.noFloat;
  return fill(otherwise, { reason: sentence || message || String(error) });
}
