// pace.js -- how long a picture will take, told by smaller ones, before a browser stops it.

/** @typedef {{size: [number, number]}} Sized */
/** What is asked of a player: its state, over what its sketch says, and its pictures, made in pieces that
 *  no browser stops.
 *  @typedef {{state: {frame?: [number, number]}, renderSoon: () => Promise<unknown>,
 *             sketch: {frame: [number, number]}}} Paced */

// Of a side. The first does what is done once: the terrain, and what the driver puts off compiling.
const SHARES = [1 / 16, 1 / 8, 1 / 4];
const LIMIT = 4; // [s] a picture; drivers of Windows end a draw after 2, browsers a frame after 10

/** Estimate the time of a picture from three that are smaller; the state is as before then. What a picture
 *  needs whatever its size is kept from the first of them, and no part of the time.
 *
 *  What does not grow with the picture is found from the other two: t(share) = a + b share².
 *  @param {Paced} player
 *  @param {() => Promise<void>} done   waits for what was drawn
 *  @param {{limit?: number, now?: () => number}} [options]   limit in seconds: no larger one is drawn then
 *  @returns {Promise<number>} seconds */
export async function estimate(player, done, { limit = LIMIT, now = () => performance.now() } = {}) {
  const { state, sketch } = player, { frame } = state, whole = frame ?? sketch.frame;
  /** @type {number[]} */
  const took = [];
  try {
    for (const share of SHARES) {
      const start = now();
      state.frame = scaled(whole, share);
      await player.renderSoon();
      await done();
      took.push((now() - start) / 1000);
      if (share !== SHARES[0] && took[took.length - 1] > limit) return took[took.length - 1] / share ** 2;
    }
  } finally {
    Object.assign(state, { frame });
  }
  const [, less, more] = took, [, a, b] = SHARES;
  const slope = Math.max((more - less) / (b ** 2 - a ** 2), 0);
  return Math.max(more + slope * (1 - b ** 2), 0);
}

/** A frame that will take half of the limit; null where the whole one is quick enough.
 *  @param {number} seconds  of the frame @param {[number, number]} frame @param {number} [limit]
 *  @returns {[number, number] | null} */
export function smallerFrame(seconds, frame, limit = LIMIT) {
  if (seconds <= limit) return null;
  const share = Math.sqrt(limit / 2 / seconds);
  return scaled(frame, share);
}

/** @param {[number, number]} frame @param {number} share @returns {[number, number]} */
const scaled = ([width, height], share) =>
  [Math.max(Math.round(width * share), 1), Math.max(Math.round(height * share), 1)];
