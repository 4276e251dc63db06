// dense.js -- reads bytes that are written as text, seven bits a letter: playground/publish/web/pressed.py.

// Codes of ASCII that stand for no bits of their own: controls, "&", "<", and delete.
const ESCAPED = [0, 7, 8, 9, 10, 11, 12, 13, 26, 27, 38, 60, 127];
const FIRST = 2; // of the groups of 128 letters that stand for one of those and 7 bits more

/** The bytes of such a text. @param {string} text @returns {Uint8Array<ArrayBuffer>} */
export function undense(text) {
  const found = new Uint8Array(text.length * 2);
  let at = 0, held = 0, bits = 0; // of what is held, the lowest are still to be written
  for (let place = 0; place < text.length; place++) {
    const letter = text.charCodeAt(place), low = letter & 127;
    const before = letter > 127 ? ESCAPED[(letter >> 7) - FIRST] : undefined;
    if (before === undefined) {
      held = (held << 7) | low;
      bits += 7;
    } else {
      held = (held << 14) | (before << 7) | low;
      bits += 14;
    }
    while (bits >= 8) found[at++] = held >> (bits -= 8);
  }
  return found.slice(0, at);
}
