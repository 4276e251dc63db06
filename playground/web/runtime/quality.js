// quality.js -- how many pixels a picture gets: all of the screen's at rest, fewer in a slow motion.

const LEVELS = [1, 0.75, 0.5, 0.35, 0.25];
/** [ms] a frame in motion may take before its picture gets fewer pixels. */
export const SLOW = 60;
/** [ms] without motion until the picture is sharp again. */
export const REST = 300;
const GAIN = 0.85; // fewer pixels must make a frame so much faster at least, or they are given back

/** The pixels of a picture that fills a box, sharp on a dense screen, within a budget.
 *  @param {[number, number]} box CSS pixels @param {number} density @param {number} budget
 *  @param {number} [scale]
 *  @returns {[number, number]} */
export function pixelsOf(box, density, budget, scale = 1) {
  const area = box[0] * box[1] * density * density;
  const factor = density * Math.min(1, Math.sqrt(budget / Math.max(area, 1))) * scale;
  return [Math.max(Math.round(box[0] * factor), 1), Math.max(Math.round(box[1] * factor), 1)];
}

/** Make a judge of frames: it is told how long each took, and says how large the next is to be. */
export function createQuality() {
  let level = 0,
    floor = LEVELS.length - 1,
    quick = 0;
  /** @type {(number | undefined)[]} */
  let costs = [];
  return {
    get scale() {
      return LEVELS[level];
    },
    /** The picture is at rest: the next is whole. What was learned stays for the next motion. */
    rest() {
      level = 0;
    },
    /** A motion begins: as large as the last one ended. */
    begin() {
      level = Math.min(quick, floor);
    },
    /** A frame in motion took so long. @param {number} milliseconds */
    took(milliseconds) {
      costs[level] = milliseconds;
      const larger = level > 0 ? costs[level - 1] : undefined;
      if (larger !== undefined && milliseconds > GAIN * larger && larger > SLOW) {
        // Its pixels are not what makes it slow.
        floor = level = level - 1;
      } else if (milliseconds > SLOW && level < floor) level += 1;
      else if (milliseconds < SLOW / 4 && level > 0) level -= 1;
      quick = level;
    },
    /** Another sketch, another cost. */
    forget() {
      [level, floor, quick, costs] = [0, LEVELS.length - 1, 0, []];
    },
  };
}
