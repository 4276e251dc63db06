// engine.js -- one WebGL2 context for many figures: what they share, and what is left when it is lost.

import { addOns } from "./addons.js";
import { createBinder } from "./binder.js";
import { createCache } from "./cache.js";
import { failure, openContext } from "./context.js";
import { createDraws } from "./draws.js";
import { createImages } from "./images.js";
import { createKernels } from "./kernels.js";
import { createPlayer } from "./player.js";
import { createPrograms } from "./programs.js";
import { createClock } from "./slices.js";
import { createTextures } from "./textures.js";

/** @typedef {import("./player.js").Player} Player */

/** `bytes` bounds what is kept of textures, `without` lists extensions of WebGL to do without; after `often`
 *  draws with the same choices these are written into a program (chosen.js).
 *  @typedef {{bytes?: number, without?: string[], often?: number}} Options */

/** What lives in the context, and is made again when it was lost.
 *  @typedef {object} Parts
 *  @property {import("./context.js").Context} context
 *  @property {import("./textures.js").Textures} textures
 *  @property {import("./programs.js").Programs} programs
 *  @property {import("./images.js").Images} images
 *  @property {import("./binder.js").Binder} binder
 *  @property {import("./kernels.js").Kernels} kernels
 *  @property {ReturnType<typeof createDraws>} draws
 *  @property {ReturnType<typeof import("./plain.js").createPlain> | undefined} plain  an add-on
 *  @property {import("./cache.js").Cache} cache */

/** @typedef {object} Engine
 *  @property {Parts} parts
 *  @property {import("./schema.js").Shared} shared
 *  @property {HTMLCanvasElement | OffscreenCanvas} canvas
 *  @property {import("./slices.js").Clock} clock
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
    const plain = addOns.plain?.createPlain(context, textures, images, binder, kernels);
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
      for (const part of [cache, textures, images, binder, draws, plain, programs]) part?.clear();
      canvas.removeEventListener("webglcontextlost", keep);
    },
  };
  return engine;
};
