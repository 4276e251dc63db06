// work_check.js -- judges a reader's work and scores a picture, as playground/course/tasks.py does.

import { general } from "./numbers.js";
import { createSession } from "./session.js";
import { leavesOf } from "./values.js";
import { fill } from "./words.js";

/** @import { Sketch, Value } from "./schema.js" */

// ── What is said of a work that was checked, as playground/course/tasks.py does.
//
// The words are those of [tasks] in course/labels, which a book's scripts hold.

const NARROW = "\u202f"; // the space before a sign of percent

/** A number in a language. @param {string} text @param {boolean} comma */
const local = (text, comma) => (comma ? text.replace(".", ",") : text);

/** A share in percent, to two digits, never as a power of ten. @param {number} share */
function percent(share) {
  const value = 100 * share, rounded = Number(value.toExponential(1));
  const power = rounded ? Math.floor(Math.log10(Math.abs(rounded))) : 0;
  return `${rounded.toFixed(Number.isInteger(value) ? 0 : Math.max(1 - power, 0))}${NARROW}%`;
}

/** @param {number[]} size  width, height, channels of a texture @param {Object<string, string>} say */
function sized([width, height, channels], say) {
  return fill(say.channels, { width, height, channels });
}

/** What comes of one check, as a sentence. @param {Outcome} found @param {PageCheck} check
 *  @param {Object<string, string>} say  of [tasks] in course/labels @param {boolean} comma */
export function sentence(found, check, say, comma) {
  const at = check.said.map(([path, value]) => `${path} = ${local(value, comma)}`).join(", ");
  const where = check.hidden ? say.hidden : at ? fill(say.at, { at }) : "";
  const what = whatOf(found, check, say, comma);
  const isName = check.of && what.startsWith(check.of.name);
  return where || isName ? where + what : what[0].toUpperCase() + what.slice(1);
}

/** @param {Outcome} found @param {PageCheck} check @param {Object<string, string>} say
 *  @param {boolean} comma */
function whatOf(found, check, say, comma) {
  const kind = check.of ? "texture" : "picture", of = check.of?.name ?? "";
  if (found.mistake) return fill(say.mistake, { mistake: found.mistake.replace(/\.+$/, "") });
  if (found.passed) return fill(say[`right_${kind}`], { of });
  if (found.sizes) {
    const [mine, wanted] = found.sizes.map((size) => sized(size, say));
    return fill(say.size, { of, mine, wanted });
  }
  if (found.notFinite) {
    const key = found.notFinite > 1 ? "not_finite" : "not_finite_one";
    return fill(say[key], { of, count: found.notFinite });
  }
  const place = found.place ? say[`${check.of ? "map" : "place"}_${found.place}`] : "";
  const bias = found.bias ? say[`bias_${kind}_${found.bias > 0 ? "more" : "less"}`] : "";
  const [by, tolerance] = [found.difference, check.tolerance].map((value) => local(general(value, 3), comma));
  const share = local(percent(found.difference), comma);
  return fill(say[`wrong_${kind}`], { of, share, by, tolerance, place, bias });
}

// ── Whether a picture is the one that was asked for.
//
// The same formula may be written in another order, which moves a float's last digit and so a pixel by a
// level, or an edge by a pixel. What is asked for is a picture that nobody could tell from the right one.

export const LEVELS = 3; // of 255 that no eye sees
export const SHARE = 0.002; // of all pixels that may differ by more

const PIECE = 360; // pixels that are compared, each way at most

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
function sizeToCompare([width, height], side = PIECE) {
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

// ── Judges a reader's work and scores a picture, as playground/course/tasks.py does.

/** What a work is judged by.
 *  @typedef {object} PageCheck
 *  @property {boolean} hidden
 *  @property {number} tolerance                    share of pixels, or difference of a texel
 *  @property {[string, string][]} said             paths and values, as a reader is told them
 *  @property {Object<string, Value>} at            by leaf, over the exercise's own
 *  @property {{path: string, output: string, name: string}} [of]  a texture; else the picture */
/** @typedef {{size: [number, number], data: Uint8ClampedArray}} Shot  row 0 south */
/** What came of a check: see CheckResult in playground/course/tasks.py.
 *  @typedef {{passed: boolean, difference: number, bias?: number, place?: string, mistake?: string,
 *             notFinite?: number, sizes?: [number[], number[]], mine?: Shot, wanted?: Shot,
 *             differs?: Shot}} Outcome  sizes: width, height, channels */

const SIDE = 240; // pixels of the longer side of the pictures that are compared
const MIN_FRACTION = 0.6; // of all that differs lies in a third of a picture, to say that it lies there
const BRIGHTER = 1; // level of 255, in the mean, from which a picture is called brighter or darker

/** Judge works for an exercise; the answer is drawn once.
 *  @param {{open: (sketch: Sketch) => any}} engine @param {Sketch} solution @param {Sketch} begin
 *  @param {{file: string, answer: string, checks: PageCheck[]}} exercise */
export function createJudge(engine, solution, begin, { file, answer, checks }) {
  const right = opened(engine, solution, file, answer), mine = engine.open(begin);
  /** @type {any[]} */
  const known = [];
  return {
    /** @param {Object<string, any> | null} state  what was set; null: a kernel is judged, at its own values
     *  @param {string} text  of the file @returns {Promise<Outcome[]>} */
    async judged(state, text) {
      if (file) mine.texts = { ...mine.texts, [file]: text };
      mine.forget();
      const found = [];
      for (const [at, check] of checks.entries()) {
        known[at] ??= await made(right, createSession([solution]).state(), solution, check);
        found.push(await compared(state ?? createSession([begin]).state(), check, known[at]));
      }
      return found;
    },
  };

  /** @param {Object<string, any>} state @param {PageCheck} check @param {any} wanted */
  async function compared(state, check, wanted) {
    const lacking = Object.keys(check.at).find((path) => lacks(begin, path));
    if (lacking) {
      const name = lacking.slice(lacking.lastIndexOf(".") + 1);
      const mistake = `the kernel has no parameter '${name}', which is set here`;
      return { passed: false, difference: Infinity, mistake };
    }
    try {
      const own = await made(mine, state, begin, check);
      return check.of ? compareTextures(own, wanted, check) : comparePictures(own, wanted, check);
    } catch (error) {
      const mistake = error instanceof Error ? error.message : String(error);
      return { passed: false, difference: Infinity, mistake };
    }
  }
}

/** Whether the kernel that had a parameter has it no more. @param {Sketch} sketch @param {string} path */
function lacks({ kernels, nodes }, path) {
  return leavesOf(nodes).some(({ kernel, values }) =>
    Object.entries(values).some(([name, to]) =>
      to === path && kernels[kernel].parameters.every((one) => one.name !== name)));
}

/** @param {{open: (sketch: Sketch) => any}} engine @param {Sketch} sketch @param {string} file
 *  @param {string} text */
function opened(engine, sketch, file, text) {
  const player = engine.open(sketch);
  if (file) player.texts = { [file]: text };
  return player;
}

/** Draw a sketch as a check asks for it; return its picture or its texture.
 *  @param {any} player @param {Object<string, any>} state @param {Sketch} sketch
 *  @param {Pick<PageCheck, "at" | "of">} check */
async function made(player, state, sketch, { at, of }) {
  const frame = sizeToCompare(sketch.frame, SIDE), values = { ...state.values, ...at };
  Object.assign(player.state, state, { values, frame, camera: null, time: sketch.time, map: null });
  await player.load();
  if (of) return player.read({ path: of.path, output: of.output });
  player.render();
  return { size: frame, data: player.picture() };
}

/** @param {any} mine @param {any} wanted @param {PageCheck} check @returns {Outcome} */
export function comparePictures(mine, wanted, check) {
  const share = difference(mine.data, wanted.data), differs = new Uint8ClampedArray(mine.data.length);
  const wrong = new Float64Array(mine.data.length / 4);
  let sum = 0;
  for (let at = 0; at < mine.data.length; at += 4) {
    let most = 0;
    for (let part = 0; part < 3; part++) {
      const apart = mine.data[at + part] - wanted.data[at + part];
      sum += apart;
      most = Math.max(most, Math.abs(apart));
    }
    const grey = wanted.data[at] * 0.1 + wanted.data[at + 1] * 0.2 + wanted.data[at + 2] * 0.05;
    wrong[at / 4] = Number(most > LEVELS);
    differs.set(most > LEVELS ? [255, 150 - Math.min(most, 130), 40, 255] : [grey, grey, grey, 255], at);
  }
  const bias = sum / (0.75 * mine.data.length);
  const shots = {
    mine: { size: mine.size, data: new Uint8ClampedArray(mine.data) },
    wanted: { size: wanted.size, data: new Uint8ClampedArray(wanted.data) },
    differs: { size: mine.size, data: differs },
  };
  return {
    passed: share <= check.tolerance, difference: share, bias: Math.abs(bias) > BRIGHTER ? bias : 0,
    place: placeOf(wrong, mine.size), ...shots,
  };
}

/** @param {any} mine @param {any} wanted @param {Pick<PageCheck, "tolerance">} check @returns {Outcome} */
export function compareTextures(mine, wanted, { tolerance }) {
  const sizes = [mine, wanted].map(({ size, channels }) => [...size, channels]);
  if (sizes[0].join() !== sizes[1].join()) {
    return { passed: false, difference: Infinity, sizes: /** @type {[number[], number[]]} */ (sizes) };
  }
  const wrong = new Float64Array(mine.size[0] * mine.size[1]);
  let largest = 0, sum = 0;
  const strange = new Set();
  for (let at = 0; at < mine.data.length; at++) {
    const apart = mine.data[at] - wanted.data[at];
    if (!Number.isFinite(mine.data[at])) strange.add(Math.floor(at / mine.channels));
    sum += apart;
    largest = Math.max(largest, Math.abs(apart));
    const texel = Math.floor(at / mine.channels);
    if (Math.abs(apart) > tolerance) wrong[texel] = Math.max(wrong[texel], Math.abs(apart));
  }
  if (strange.size) return { passed: false, difference: Infinity, notFinite: strange.size };
  const bias = sum / mine.data.length;
  return {
    passed: largest <= tolerance, difference: largest, bias: Math.abs(bias) > tolerance ? bias : 0,
    place: placeOf(wrong, mine.size),
  };
}

/** Where most of what differs lies, as "top-left", "left" or "middle"; "" where it lies in no third.
 *  @param {ArrayLike<number>} amount  of each texel, row 0 south @param {[number, number]} size */
export function placeOf(amount, [width, height]) {
  const rows = new Float64Array(height), columns = new Float64Array(width);
  let total = 0;
  for (let at = 0; at < width * height; at++) {
    rows[height - 1 - Math.floor(at / width)] += amount[at];
    columns[at % width] += amount[at];
    total += amount[at];
  }
  if (!total) return "";
  const [down, across] = [
    named(rows, total, ["top", "", "bottom"]), named(columns, total, ["left", "", "right"]),
  ];
  if (down === across) return down === "" ? "middle" : "";
  return [down, across].filter(Boolean).join("-");
}

/** The third that holds most of an amount, of those that are as long as can be; null: none.
 *  @param {Float64Array} amount @param {number} total @param {string[]} names */
function named(amount, total, names) {
  let from = 0;
  for (const [third, name] of names.entries()) {
    const to = from + Math.floor(amount.length / 3) + Number(third < amount.length % 3);
    if (amount.slice(from, to).reduce((sum, one) => sum + one, 0) / total > MIN_FRACTION) return name;
    from = to;
  }
  return null;
}

/** Return what gives a challenge's score of a work: 100 for the picture asked for, 0 for the one to begin
 * from.
 *  @param {{open: (sketch: Sketch) => any}} engine @param {Sketch} solution @param {Sketch} begin
 *  @param {{file: string, answer: string, starter: string}} challenge */
export function createScore(engine, solution, begin, { file, answer, starter }) {
  const right = opened(engine, solution, file, answer), mine = engine.open(begin);
  const plain = { at: {} };
  /** @type {Uint8Array | null} */
  let target = null;
  /** @type {Uint8Array | null} */
  let first = null;
  /** @param {Object<string, any>} state @param {string} text */
  const drawn = async (state, text) => {
    if (file) {
      mine.texts = { [file]: text };
      mine.forget();
    }
    return (await made(mine, state, begin, plain)).data;
  };
  /** @param {Object<string, any>} state @param {string} text @returns {Promise<number>} */
  return async (state, text) => {
    target ??= (await made(right, createSession([solution]).state(), solution, plain)).data;
    first ??= await drawn(createSession([begin]).state(), starter);
    return scoreOf(/** @type {any} */ (target), /** @type {any} */ (first), await drawn(state, text));
  };
}

/** @param {Uint8Array} target @param {Uint8Array} begin @param {Uint8Array} mine */
function scoreOf(target, begin, mine) {
  if (difference(target, mine) <= SHARE) return 100;
  const whole = meanDifference(target, begin);
  return whole ? 100 * Math.max(0, 1 - meanDifference(target, mine) / whole) : 0;
}

/** The mean absolute difference of the colours. @param {Uint8Array} one @param {Uint8Array} other */
function meanDifference(one, other) {
  let sum = 0;
  for (let at = 0; at < one.length; at++) if (at % 4 !== 3) sum += Math.abs(one[at] - other[at]);
  return sum / (0.75 * one.length);
}
