// pressed.js -- unpacks the text that a page is made of: playground/web/pressed.py.

import { undense } from "./dense.js";
import { unlzma } from "./lzma.js";

/** The bytes that others stand for: after a list of bytes, each with the letters of its word, and a zero.
 *  @param {Uint8Array} bytes @returns {Uint8Array} */
function withWords(bytes) {
  /** @type {Uint8Array[]} */
  const words = [], isLetter = (/** @type {number} */ byte) => /[a-z]/i.test(String.fromCharCode(byte));
  let from = 0;
  while (bytes[from]) {
    const code = bytes[from++], begin = from;
    while (isLetter(bytes[from])) from++;
    words[code] = bytes.subarray(begin, from);
  }
  const coded = bytes.subarray(from + 1);
  const found = new Uint8Array(coded.reduce((sum, byte) => sum + (words[byte]?.length ?? 1), 0));
  let at = 0;
  for (const byte of coded) {
    const word = words[byte];
    if (word) found.set(word, at);
    else found[at] = byte;
    at += word ? word.length : 1;
  }
  return found;
}

/** The text that such a text holds: four bytes that count its bytes, the lowest first, then LZMA.
 *  @param {string} text @returns {string} */
export function unpressed(text) {
  const bytes = undense(text), [length] = new Uint32Array(bytes.slice(0, 4).buffer);
  return new TextDecoder("utf-8", { ignoreBOM: true }).decode(withWords(unlzma(bytes.subarray(4), length)));
}
