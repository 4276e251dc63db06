// engine.js -- one WebGL2 context for many figures: what they share, and what is left when it is lost.

import { createBinder } from "./binder.js";
import { createCache } from "./cache.js";
import { failure, finished, openContext } from "./context.js";
import { createDraws } from "./draws.js";
import { createKernels } from "./kernels.js";
import { createPlain } from "./plain.js";
import { createPlayer } from "./player.js";
import { createPrograms } from "./programs.js";
import { createImages, createTextures } from "./textures.js";

/** @import { KernelText } from "./kernel_texts.js"
 *  @import { Player } from "./player.js" */

// ── Long work in slices: between them the browser draws and listens; what each kernel takes is
// measured.

/** @typedef {{text: KernelText, texels: number}} Piece */
/** @typedef {ReturnType<typeof createClock>} Clock */

const PROBE = 64 * 1024; // texels that are drawn first of what was never measured
const MAX_CALL_TIME = 500; // [ms] of one call where nothing waits: watchdogs act after 2000

/** What kernels took, by their texts: milliseconds a texel. */
const createClock = () => {
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

// ── One WebGL2 context for many figures

/** `bytes` bounds what is kept of textures, `without` lists extensions of WebGL to do without; after `often`
 *  draws with the same choices these are written into a program (kernels.js).
 *  @typedef {{bytes?: number, without?: string[], often?: number}} Options */

/** What lives in the context, and is made again when it was lost.
 *  @typedef {object} Parts
 *  @property {import("./context.js").Context} context
 *  @property {import("./textures.js").Textures} textures
 *  @property {import("./programs.js").Programs} programs
 *  @property {import("./textures.js").Images} images
 *  @property {import("./binder.js").Binder} binder
 *  @property {import("./kernels.js").Kernels} kernels
 *  @property {ReturnType<typeof createDraws>} draws
 *  @property {ReturnType<typeof createPlain>} plain
 *  @property {import("./cache.js").Cache} cache */

/** @typedef {object} Engine
 *  @property {Parts} parts
 *  @property {import("./schema.js").Shared} shared
 *  @property {HTMLCanvasElement | OffscreenCanvas} canvas
 *  @property {Clock} clock
 *  @property {(sketch: import("./schema.js").Sketch) => Player} open
 *  @property {() => Promise<void>} restore    after the context came back: all players are loaded again
 *  @property {() => boolean} isLost
 *  @property {() => Object<string, number>} counts   WebGL's objects that live, by kind
 *  @property {() => number} bytes             of textures that are kept
 *  @property {() => void} trim                releases programs that no player needs, all but the latest
 *  @property {() => void} close */

const BYTES = 384 * 2 ** 20;
const POOL_SHARE = 8; // spare textures may take an eighth of what is kept

/** Open an engine on a canvas. Throws a `Failure` with a code where the device cannot run it.
 *  @param {HTMLCanvasElement | OffscreenCanvas} canvas @param {import("./schema.js").Shared} shared
 *  @param {Options} [options] @returns {Engine} */
export const createEngine = (canvas, shared, options = {}) => {
  const bytes = options.bytes || BYTES;
  /** @type {Set<Player>} */
  const players = new Set();

  /** @returns {Parts} */
  const build = () => {
    const context = openContext(canvas, options), textures = createTextures(context, bytes / POOL_SHARE);
    const programs = createPrograms(context), images = createImages(textures, shared);
    const binder = createBinder(context, textures, images);
    const kernels = createKernels(context, textures, programs, binder, shared, options.often);
    const draws = createDraws(context, textures, programs, binder, kernels);
    const plain = createPlain(context, textures, images, binder, kernels);
    const cache = createCache(bytes, textures);
    return { context, textures, programs, images, binder, kernels, draws, plain, cache };
  };

  /** @param {Event} event */
  const keep = (event) => event.preventDefault(); // or it would never come back
  canvas.addEventListener("webglcontextlost", keep);

  /** @type {Engine} */
  const engine = {
    parts: build(),
    shared,
    canvas,
    clock: createClock(),
    open: (sketch) => {
      const player = createPlayer(engine, sketch, () => players.delete(player));
      players.add(player);
      return player;
    },
    restore: async () => {
      if (engine.isLost()) throw failure("context-lost", "The graphics context is not back yet.");
      for (const player of players) player.forget();
      engine.parts = build();
      for (const player of players) await player.load();
    },
    isLost: () => engine.parts.context.gl.isContextLost(),
    counts: () => engine.parts.context.counts(),
    bytes: () => engine.parts.cache.bytes + engine.parts.textures.bytes,
    trim: () =>
      engine.parts.programs.trim(() => new Set([...players].flatMap((player) => player.programs()))),
    close: () => {
      for (const player of [...players]) player.close();
      const { cache, textures, images, binder, draws, plain, programs } = engine.parts;
      for (const part of [cache, textures, images, binder, draws, plain, programs]) part.clear();
      canvas.removeEventListener("webglcontextlost", keep);
    },
  };
  return engine;
};
