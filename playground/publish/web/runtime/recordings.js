// recordings.js -- which exported frame of a film or a sound shows at a time: engine/time_sources.py.

/** @typedef {import("./schema.js").DataTexture} DataTexture */

// [s] A time is meant to be that of the frame that begins so little later.
const MARGIN = 1e-6;

/** Which second of the file shows, before it loops, and whether it does.
 *  @typedef {{start: number, speed?: number, loop: boolean}} Playing */

/** Return the blob that a texture of a source has at a time in seconds; of what does not play, its own.
 *  @param {DataTexture} texture @param {Playing | null} playing @param {number} time @returns {string} */
export function blobAt(texture, playing, time) {
  const { length = 0, laps } = texture;
  if (!texture.times || !texture.frames || !playing) return texture.blob;
  let { times, frames } = texture, second = playing.start + (playing.speed ?? 1) * time + MARGIN;
  const before = second < 0 && playing.speed === undefined; // of a sound, which begins in silence
  if (playing.loop && length > 0 && !before) {
    const lead = laps ? laps.lead : 0, once = laps ? lead + length : 0; // after that nothing is new
    if (second < 0 || second >= once) second -= Math.floor((second - lead) / length) * length;
    if (laps && second >= length) ({ times, frames } = laps);
  }
  let low = 0, high = times.length; // as Python's bisect_right
  while (low < high) {
    const middle = (low + high) >> 1;
    if (second < times[middle]) high = middle;
    else low = middle + 1;
  }
  return frames[Math.max(low - 1, 0)];
}

/** Return how a source plays its file; null of one that plays none.
 *  @param {import("./schema.js").Leaf} leaf
 *  @param {Object<string, import("./schema.js").Value>} values of its parameters, by name
 *  @returns {Playing | null} */
export function playingOf({ clock, values: paths }, values) {
  if (!clock) return null;
  const byPath = new Map(Object.entries(paths).map(([name, path]) => [path, values[name]]));
  const speed = clock.speed === undefined ? undefined : Number(byPath.get(clock.speed));
  return { start: Number(byPath.get(clock.start)), speed, loop: Boolean(byPath.get(clock.loop)) };
}
