// picture_check.js -- whether a picture is the one that was asked for.
//
// The same formula may be written in another order, which moves a float's last digit and so a pixel by a
// level, or an edge by a pixel. What is asked for is a picture that nobody could tell from the right one.

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./player.js").Player} Player */

export const LEVELS = 3; // of 255 that no eye sees
export const SHARE = 0.002; // of all pixels that may differ by more

const SIDE = 360; // pixels that are compared, each way at most

/** The share of the pixels that differ by more than `LEVELS` in a colour; 1 for another size.
 *  @param {Uint8Array} one @param {Uint8Array} other */
export function difference(one, other) {
  if (one.length !== other.length) return 1;
  let count = 0;
  for (let at = 0; at < one.length; at += 4) {
    for (let part = 0; part < 3; part++) {
      if (Math.abs(one[at + part] - other[at + part]) > LEVELS) {
        count++;
        break;
      }
    }
  }
  return (4 * count) / one.length;
}

/** Pixels of the pictures that are compared: of the sketch's shape. @param {[number, number]} frame
 *  @param {number} [side]  each way at most
 *  @returns {[number, number]} */
export function sizeToCompare([width, height], side = SIDE) {
  const scale = Math.min(1, side / Math.max(width, height));
  return [Math.max(Math.round(width * scale), 16), Math.max(Math.round(height * scale), 16)];
}

/** Compare pictures with that of a sketch as it is; `state` is a session's.
 *  @param {{open: (sketch: Sketch) => any}} engine @param {Sketch} sketch
 *  @param {Object<string, any>} state */
export async function createCheck(engine, sketch, state) {
  const player = engine.open(sketch), frame = sizeToCompare(sketch.frame);
  const draw = (/** @type {Object<string, any>} */ wanted) => {
    Object.assign(player.state, wanted, { frame, camera: null, time: sketch.time, map: null });
    player.render();
    return /** @type {Uint8Array} */ (player.picture());
  };
  Object.assign(player.state, state, { frame });
  await player.load();
  const right = draw(state);
  return {
    /** Whether a state gives the right picture. @param {Object<string, any>} wanted */
    async holds(wanted) {
      Object.assign(player.state, wanted, { frame });
      await player.load();
      return difference(draw(wanted), right) <= SHARE;
    },
    /** Whether a text in place of a file's does; false for one with errors.
     *  @param {string} file @param {string} text */
    async holdsWith(file, text) {
      const { errors } = await player.edit(file, text);
      return !errors.length && difference(draw(state), right) <= SHARE;
    },
    close: () => player.close(),
  };
}
