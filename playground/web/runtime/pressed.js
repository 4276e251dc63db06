// pressed.js -- unpacks what a page holds as text of 7 bits a letter: playground/web/pressed.py.

import { unlzma } from "./lzma.js";

// Codes of ASCII that stand for no bits of their own: controls, "&", "<", and delete.
const ESCAPED = [0, 7, 8, 9, 10, 11, 12, 13, 26, 27, 38, 60, 127];

/** The bytes of such a text: 7 bits of a letter below 128, 14 of any other.
 *  @param {string} text @returns {Uint8Array} */
export function undense(text) {
  const found = new Uint8Array(text.length * 2);
  let bits = 0, held = 0, at = 0;
  const take = (/** @type {number} */ seven) => {
    held = ((held << 7) | seven) & 0x7fff;
    bits += 7;
    if (bits >= 8) found[at++] = held >> (bits -= 8);
  };
  for (let place = 0; place < text.length; place++) {
    const letter = text.charCodeAt(place);
    if (letter > 127) take(ESCAPED[(letter >> 7) - 2]);
    take(letter & 127);
  }
  return found.subarray(0, at);
}

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
