// hash.js -- a key for any text: 128 bits, quick, for telling things apart that nobody made to collide.

const SEEDS = [0x9e3779b1, 0x85ebca6b, 0xc2b2ae35, 0x27d4eb2f]; // of different bits, and odd
const FACTORS = [0x01000193, 0x5bd1e995, 0x2c1b3c6d, 0x297a2d39];

/** Four sums over the letters, each mixed at the end so that each bit of it depends on every letter.
 *  @param {string} text */
export function hash(text) {
  const sums = [...SEEDS];
  for (let index = 0; index < text.length; index++) {
    const code = text.charCodeAt(index);
    for (let k = 0; k < 4; k++) sums[k] = Math.imul(sums[k] ^ (code + (sums[k] >>> 15)), FACTORS[k]);
  }
  return sums.map((sum, k) => {
    let mixed = sum ^ text.length ^ sums[(k + 1) % 4];
    for (const factor of FACTORS) mixed = Math.imul(mixed ^ (mixed >>> 16), factor | 1);
    return ((mixed ^ (mixed >>> 15)) >>> 0).toString(16).padStart(8, "0");
  }).join("");
}
