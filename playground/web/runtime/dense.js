// dense.js -- reads bytes that are written as text, seven bits a letter: playground/web/pressed.py.

// Codes of ASCII that stand for no bits of their own: controls, "&", "<", and delete.
const ESCAPED = [0, 7, 8, 9, 10, 11, 12, 13, 26, 27, 38, 60, 127];
const FIRST = 2; // of the groups of 128 letters that stand for one of those and 7 bits more

/** The bytes of such a text. @param {string} text @returns {Uint8Array<ArrayBuffer>} */
export function undense(text) {
  const found = new Uint8Array(text.length * 2);
  let bits = 0, held = 0, at = 0;
  const take = (/** @type {number} */ seven) => {
    held = ((held << 7) | seven) & 0x7fff;
    bits += 7;
    if (bits >= 8) found[at++] = held >> (bits -= 8);
  };
  for (let place = 0; place < text.length; place++) {
    const letter = text.charCodeAt(place), before = ESCAPED[(letter >> 7) - FIRST];
    if (before !== undefined) take(before);
    take(letter & 127);
  }
  return found.slice(0, at);
}
