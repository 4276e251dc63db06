// work_check.js -- judges a reader's work as tasks/judge.py does, and says how near a picture is as score.py.

import { LEVELS, SHARE, difference, sizeToCompare } from "./picture_check.js";
import { createSession } from "./session.js";
import { leavesOf } from "./values.js";

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./schema.js").Value} Value */

/** What a work is judged by.
 *  @typedef {object} PageCheck
 *  @property {boolean} hidden
 *  @property {number} tolerance                    share of pixels, or difference of a texel
 *  @property {[string, string][]} said             paths and values, as a reader is told them
 *  @property {Object<string, Value>} at            by leaf, over the exercise's own
 *  @property {{path: string, output: string, name: string}} [of]  a texture; else the picture */
/** @typedef {{size: [number, number], data: Uint8ClampedArray}} Shot  row 0 south */
/** What came of a check: see Result in verdict.py.
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
export function scoreOf(target, begin, mine) {
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
