// quality.js -- how many pixels a picture gets: all of the screen's at rest, fewer in a slow motion.

const LEVELS = [1, 0.75, 0.5, 0.35, 0.25];
/** [ms] a frame in motion may take before its picture gets fewer pixels. */
export const SLOW = 60;
/** [ms] without motion until the picture is sharp again. */
export const REST = 300;
const ROOM = 0.8; // of that, what a larger one may take by its pixels, before it gets them
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

/** Make a judge of frames: it is told how long each took, and says how large the next is to be.
 *
 *  A frame takes a time of its own and one that follows its pixels. Of two sizes, each with a frame after
 *  another of that size, for the first makes textures too, both are known, and so what each size would take.
 */
export function createQuality() {
  let level = 0,
    quick = 0,
    drawn = -1; // the level of the last frame
  /** @type {{first: number, least: number}[]} what frames took, by level; least: after the first */
  let costs = [];

  /** The level at which a frame would be quick enough, were its pixels all that takes time.
   *  @param {number} milliseconds */
  function promising(milliseconds) {
    const wanted = LEVELS[level] * Math.sqrt(SLOW / milliseconds);
    const found = LEVELS.findIndex((side) => side <= wanted);
    return found < 0 ? LEVELS.length - 1 : found;
  }

  /** The largest size that is quick enough; where none is, the smallest if it gains by that, else the whole.
   *  @param {number} other another level whose frames are known */
  function best(other) {
    const [one, two] = [level, other].map((at) => ({ pixels: LEVELS[at] ** 2, took: costs[at].least }));
    const each = Math.max((one.took - two.took) / (one.pixels - two.pixels), 0);
    const fixed = Math.max(one.took - each * one.pixels, 0);
    const took = LEVELS.map((side) => fixed + each * side * side);
    const found = took.findIndex((milliseconds) => milliseconds <= SLOW);
    if (found >= 0) return found;
    const last = LEVELS.length - 1;
    return took[last] < GAIN * took[0] ? last : 0;
  }

  /** The size of the next frame, as its level. @param {number} milliseconds */
  function next(milliseconds) {
    const { least } = costs[level], slow = milliseconds > SLOW;
    const known = LEVELS.findIndex((_, at) => at !== level && costs[at]?.least < Infinity);
    if (least < Infinity && known >= 0) return best(known);
    if (!slow) {
      const larger = level > 0 ? milliseconds * (LEVELS[level - 1] / LEVELS[level]) ** 2 : Infinity;
      return larger < ROOM * SLOW ? level - 1 : level;
    }
    if (least === Infinity) return known < 0 ? Math.max(promising(milliseconds), level) : level;
    const seen = LEVELS.findIndex((_, at) => at < level && costs[at]);
    if (seen >= 0 && costs[seen].first > 2 * least) return level; // that is more than textures take
    // Are its pixels what makes it slow?
    return seen >= 0 ? seen : level > 0 ? level - 1 : promising(milliseconds);
  }

  return {
    get scale() {
      return LEVELS[level];
    },
    /** The picture is at rest: the next is whole. What was learned stays for the next motion. */
    rest() {
      level = 0;
    },
    /** A motion begins, of another kind maybe: as large as the last one ended, and nothing is known of it. */
    begin() {
      [costs, drawn] = [[], -1];
      level = quick;
    },
    /** A frame in motion took so long. @param {number} milliseconds */
    took(milliseconds) {
      const own = (costs[level] ??= { first: milliseconds, least: Infinity });
      if (drawn === level) own.least = Math.min(own.least, milliseconds);
      drawn = level;
      quick = level = next(milliseconds);
    },
    /** Another sketch, another cost. */
    forget() {
      [level, quick, drawn, costs] = [0, 0, -1, []];
    },
  };
}
