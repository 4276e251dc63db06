// recordings.js -- which frame of what plays a file shows at a time: a film's, or a sound's.

/** @typedef {import("./schema.js").DataTexture} DataTexture */
/** @typedef {import("./schema.js").Leaf} Leaf */
/** @typedef {import("./schema.js").Value} Value */

const MARGIN = 1e-6; // [s] what is rounded down to just before a frame's time is at it

/** The texels of a source at a time [s], by output: of one that plays a file, the frame of then.
 *  @param {Leaf} leaf @param {Object<string, Value>} values of the source's parameters, by name
 *  @param {number} time @returns {{output: string, format: string, blob: string}[]} */
export function shownAt({ data = [], clock, values: paths }, values, time) {
  /** @param {string | undefined} path @param {Value} unset @returns {Value} */
  const said = (path, unset) => {
    const name = Object.keys(paths).find((each) => paths[each] === path);
    return name === undefined ? unset : values[name];
  };
  const start = Number(said(clock?.start, 0)), speed = Number(said(clock?.speed, 1));
  const loop = Boolean(said(clock?.loop, false));
  return data.map(({ output, format, blob, times, frames, length = 0 }) => {
    if (!times || !frames) return { output, format, blob };
    let seconds = start + speed * time + MARGIN;
    if (loop && length > 0) seconds = ((seconds % length) + length) % length;
    const later = times.findIndex((each) => each > seconds);
    return { output, format, blob: frames[Math.max((later < 0 ? frames.length : later) - 1, 0)] };
  });
}
