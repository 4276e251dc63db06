// pressed.js -- unpacks the text that a page is made of: playground/publish/web/pressed.py.

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

/** The Adler-32 checksum of bytes (RFC 1950). @param {Uint8Array} bytes */
function checksum(bytes) {
  let low = 1, high = 0;
  for (const byte of bytes) {
    low = (low + byte) % 65521;
    high = (high + low) % 65521;
  }
  return high * 65536 + low;
}

/** The text that such a text holds: two numbers of four bytes, the lowest first, the checksum of what follows
 *  and how many bytes are unpacked, then LZMA. Damaged LZMA gives other bytes: nothing in it says so.
 *  @param {string} text @returns {string} */
export function unpressed(text) {
  const bytes = undense(text), head = new Uint8Array(8);
  head.set(bytes.subarray(0, 8));
  const [check, length] = new Uint32Array(head.buffer);
  if (checksum(bytes.subarray(4)) !== check) throw new Error("the text is damaged");
  return new TextDecoder("utf-8", { ignoreBOM: true }).decode(withWords(unlzma(bytes.subarray(8), length)));
}
