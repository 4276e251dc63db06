// pace.js -- how long a picture will take, told by smaller ones, before a browser stops it.

/** @typedef {{size: [number, number]}} Sized */
/** What is asked of a player: its state and its pictures.
 *  @typedef {{state: {frame: [number, number], terrain: Sized}, render: () => unknown}} Paced */

const SHARES = [1 / 16, 1 / 8, 1 / 4]; // of a side; the first makes the driver compile what it puts off
const LIMIT = 4; // [s] a picture; drivers of Windows end a draw after 2, browsers a frame after 10

/** Wait until everything drawn so far is done, without holding the page up.
 *  @param {WebGL2RenderingContext} gl
 *  @returns {Promise<void>} */
export function finished(gl) {
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  return new Promise((resolve) => {
    const look = () => {
      if (!fence || gl.isContextLost() || gl.clientWaitSync(fence, 0, 0) !== gl.TIMEOUT_EXPIRED) {
        gl.deleteSync(fence);
        resolve();
      } else setTimeout(look, 4);
    };
    look();
  });
}

/** Estimate the time of a picture from three that are smaller; the state is as before then.
 *
 *  What does not grow with the picture is found from two of them: t(share) = a + b share².
 *  @param {Paced} player
 *  @param {() => Promise<void>} done   waits for what was drawn
 *  @param {{limit?: number, now?: () => number}} [options]   limit in seconds: no larger one is drawn then
 *  @returns {Promise<number>} seconds */
export async function estimate(player, done, { limit = LIMIT, now = () => performance.now() } = {}) {
  const { state } = player, { frame, terrain } = state;
  /** @type {number[]} */
  const took = [];
  try {
    for (const share of SHARES) {
      const start = now();
      state.frame = /** @type {[number, number]} */ (frame.map((side) => Math.max(Math.round(side * share), 1)));
      state.terrain = { ...terrain, size: smallerTerrain(terrain.size, share) };
      try {
        player.render();
      } catch {
        state.terrain = terrain; // a kernel that takes some sizes only
        player.render();
      }
      await done();
      took.push((now() - start) / 1000);
      if (took[took.length - 1] > limit) return took[took.length - 1] / share ** 2;
    }
  } finally {
    [state.frame, state.terrain] = [frame, terrain];
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
  const [width, height] = frame.map((side) => Math.max(Math.round(side * share), 1));
  return [width, height];
}

/** A smaller terrain, of as many whole spacings: 2^n + 1 texels stay such a number.
 *  @param {[number, number]} size @param {number} share @returns {[number, number]} */
function smallerTerrain(size, share) {
  const [x, y] = size.map((side) => {
    const spacings = (side - 1) * share;
    return Number.isInteger(spacings) ? spacings + 1 : Math.max(Math.round(side * share), 2);
  });
  return [x, y];
}
