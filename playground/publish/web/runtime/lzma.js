// lzma.js -- unpacks LZMA: a raw stream as Python's lzma module writes it with lc = 3, lp = 0, pb = 0.
//
// Igor Pavlov's LZMA specification (lzma-specification.txt, 2015), in its order and with its names of parts.

const CONTEXT_BITS = 3; // lc: of the byte before that choose a literal's probabilities
const STATES = 12, LITERAL_STATES = 7; // in the latter the last was a literal
const PROBABILITY_BITS = 11, ADAPTS = 5; // 1/32 of the way with each bit
const MIN_MATCH = 2; // bytes of a match

// Where each kind of choice has its probabilities.
const IS_MATCH = 0, IS_REPEAT = IS_MATCH + STATES, IS_LATER = IS_REPEAT + STATES; // of the last 4 distances,
const IS_LONG = IS_LATER + 3 * STATES, SLOTS = IS_LONG + STATES; //   which; the last for more than one byte
const NEAR = SLOTS + 4 * 64, ALIGN = NEAR + 128, LENGTHS = ALIGN + 16, REPEAT_LENGTHS = LENGTHS + 512;
const LITERALS = REPEAT_LENGTHS + 512, ALL = LITERALS + (0x300 << CONTEXT_BITS);

/** Unpack a stream of LZMA.
 *  @param {Uint8Array} packed @param {number} length  bytes that it holds, unpacked
 *  @returns {Uint8Array} */
export function unlzma(packed, length) {
  const found = new Uint8Array(length), chances = new Uint16Array(ALL).fill(1 << (PROBABILITY_BITS - 1));
  let range = 0xffffffff, code = 0, next = 1; // the first byte is 0
  while (next < 5) code = code * 256 + packed[next++];

  const normalise = () => {
    if (range >= 2 ** 24) return;
    range *= 256;
    code = (code * 256 + packed[next++]) % 2 ** 32;
  };
  const bit = (/** @type {number} */ at) => {
    const bound = (range >>> PROBABILITY_BITS) * chances[at], isOne = code >= bound;
    if (isOne) {
      range -= bound;
      code -= bound;
      chances[at] -= chances[at] >> ADAPTS;
    } else {
      range = bound;
      chances[at] += ((1 << PROBABILITY_BITS) - chances[at]) >> ADAPTS;
    }
    normalise();
    return +isOne;
  };
  /** A number, its highest bit first. @param {number} at @param {number} bits */
  const number = (at, bits) => {
    let node = 1;
    for (let left = bits; left; left--) node = 2 * node + bit(at + node);
    return node - (1 << bits);
  };
  /** A number, its lowest bit first. @param {number} at @param {number} bits */
  const reversed = (at, bits) => {
    let node = 1, value = 0;
    for (let place = 0; place < bits; place++) {
      const one = bit(at + node);
      node = 2 * node + one;
      value += one << place;
    }
    return value;
  };
  /** Bits that are as likely 0 as 1. @param {number} bits */
  const plain = (bits) => {
    let value = 0;
    for (let left = bits; left; left--) {
      range = Math.floor(range / 2);
      const one = +(code >= range);
      code -= one * range;
      value = 2 * value + one;
      normalise();
    }
    return value;
  };
  const lengthOf = (/** @type {number} */ at) => {
    if (!bit(at)) return MIN_MATCH + number(at + 2, 3);
    return bit(at + 1) ? MIN_MATCH + 16 + number(at + 256, 8) : MIN_MATCH + 8 + number(at + 16, 3);
  };
  /** How many bytes back, less one. @param {number} count  bytes of the match */
  const distanceOf = (count) => {
    const slot = number(SLOTS + 64 * Math.min(count - MIN_MATCH, 3), 6);
    if (slot < 4) return slot;
    const bits = (slot >> 1) - 1, base = (2 | (slot & 1)) << bits;
    if (slot < 14) return base + reversed(NEAR + base - slot, bits);
    return base + 16 * plain(bits - 4) + reversed(ALIGN, 4);
  };

  let state = 0, last = [0, 0, 0, 0];
  for (let at = 0; at < length;) {
    if (!bit(IS_MATCH + state)) {
      const before = at ? found[at - 1] : 0, base = LITERALS + 0x300 * (before >> (8 - CONTEXT_BITS));
      let byte = 1;
      if (state >= LITERAL_STATES) {
        for (let there = found[at - last[0] - 1]; byte < 256;) {
          const expected = (there >> 7) & 1, one = bit(base + 256 * (1 + expected) + byte);
          there <<= 1;
          byte = 2 * byte + one;
          if (one !== expected) break;
        }
      }
      while (byte < 256) byte = 2 * byte + bit(base + byte);
      found[at++] = byte;
      state = state < 4 ? 0 : state < 10 ? state - 3 : state - 6;
      continue;
    }
    let count = 1;
    const after = (/** @type {number} */ first, /** @type {number} */ second) =>
      (state < LITERAL_STATES ? first : second);
    if (!bit(IS_REPEAT + state)) {
      count = lengthOf(LENGTHS);
      last = [distanceOf(count), last[0], last[1], last[2]];
      state = after(7, 10);
    } else {
      const which = !bit(IS_LATER + state) ? 0 : !bit(IS_LATER + STATES + state) ? 1
        : 2 + bit(IS_LATER + 2 * STATES + state);
      if (which || bit(IS_LONG + state)) {
        last.unshift(...last.splice(which, 1));
        count = lengthOf(REPEAT_LENGTHS);
        state = after(8, 11);
      } else {
        state = after(9, 11);
      }
    }
    for (const end = Math.min(at + count, length); at < end; at++) found[at] = found[at - last[0] - 1];
  }
  return found;
}
