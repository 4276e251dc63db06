// slices.js -- long work in slices: between them the browser draws and listens; what each kernel takes is
// measured.

import { finished } from "./waiting.js";

/** @typedef {import("./kernel_texts.js").KernelText} KernelText */
/** @typedef {{text: KernelText, texels: number}} Piece */
/** @typedef {ReturnType<typeof createClock>} Clock */

const PROBE = 64 * 1024; // texels that are drawn first of what was never measured
const MAX_CALL_TIME = 500; // [ms] of one call where nothing waits: watchdogs act after 2000

/** What kernels took, by their texts: milliseconds a texel. */
export const createClock = () => {
  /** @type {Map<string, number>} */
  const costs = new Map();

  /** Return what texels of a kernel will take [ms]; of one that was never measured, as the middle one.
   *  @param {KernelText} text @param {number} texels */
  const expected = ({ identity }, texels) => {
    const known = costs.get(identity);
    if (known !== undefined) return texels * known;
    const all = [...costs.values()].sort((a, b) => a - b);
    return texels * (all[all.length >> 1] ?? 0);
  };

  /** @param {Piece[]} pieces @param {number} milliseconds that all of them took */
  const note = (pieces, milliseconds) => {
    const shares = pieces.map(({ text, texels }) => expected(text, texels) || texels * 1e-9);
    const total = shares.reduce((sum, share) => sum + share, 0);
    for (const [i, { text, texels }] of pieces.entries()) {
      const now = (milliseconds * shares[i]) / total / texels;
      const before = costs.get(text.identity);
      costs.set(text.identity, before === undefined ? now : (before + now) / 2);
    }
  };

  return {
    expected,

    /** @param {KernelText} text */
    isKnown: ({ identity }) => costs.has(identity),

    /** Return how many rows of so many texels to draw at once.
     *  @param {KernelText} text @param {number} width @param {number} height
     *  @param {number} budget [ms] 0: none */
    rows: (text, width, height, budget) => {
      const known = costs.get(text.identity), limit = budget || MAX_CALL_TIME;
      if (known === undefined) return budget && width * height > 4 * PROBE ? PROBE / width : height;
      return known * width * height > limit ? Math.max(limit / (known * width), 1) : height;
    },

    /** Run work in slices of about `budget` milliseconds; null where `isStopped` says so between two of them.
     *  @template T @param {WebGL2RenderingContext} gl
     *  @param {Generator<Piece, T, boolean | undefined>} work @param {number} budget
     *  @param {() => boolean} isStopped @returns {Promise<{found: T} | null>} */
    run: async (gl, work, budget, isStopped) => {
      /** @type {Piece[]} */
      let pieces = [];
      let start = performance.now(), again = false;
      for (;;) {
        const { value, done } = work.next(again);
        again = false;
        if (!done) pieces.push(/** @type {Piece} */ (value));
        const known = pieces.every(({ text }) => costs.has(text.identity));
        const ahead = pieces.reduce((sum, { text, texels }) => sum + expected(text, texels), 0);
        if (!done && known && ahead < budget && performance.now() - start < budget) continue;
        await finished(gl);
        if (pieces.length) note(pieces, performance.now() - start);
        if (done) return { found: /** @type {T} */ (value) };
        if (isStopped()) {
          /** @type {any} */ (work).return();
          return null;
        }
        pieces = [];
        start = performance.now();
        again = true;
      }
    },
  };
};
