// figure_map.js -- a figure while it shows a texture from above: what is drawn, moved and read.

import { NOTCH } from "./camera.js";
import {
  fitted, isOfView, linesAt, movedView, paintMap, sheetOf, texelAt, WHOLE, zoomedView,
} from "./map_view.js";

/** @import { Player } from "./figure.js"
 *  @import { Texels } from "./map_view.js"
 *  @import { Session } from "./session.js" */

/** @typedef {ReturnType<typeof createFigureMap>} FigureMap */

/** Of the figure.
 *  @typedef {object} Room
 *  @property {Session} session
 *  @property {Object<string, string>} words
 *  @property {HTMLCanvasElement} canvas
 *  @property {CanvasRenderingContext2D} context
 *  @property {HTMLElement} readout
 *  @property {() => [number, number]} box    CSS pixels
 *  @property {number} budget                 pixels of the canvas at most
 *  @property {() => Player | null} player */

/** @param {Room} room */
export function createFigureMap({ session, words, canvas, context, readout, box, budget, player }) {
  const sheet = document.createElement("canvas");
  const sheetContext = /** @type {CanvasRenderingContext2D} */ (sheet.getContext("2d"));
  /** @type {Texels | Promise<Texels> | null} */
  let texels = null;
  /** @type {[number, number] | null} */
  let pointer = null;
  let view = WHOLE, fits = false, filled = false; // whether the sheet is the map's

  function texture() {
    const { map, sketch } = session;
    return sketch.textures.find(({ path, output }) => path === map?.path && output === map.output);
  }
  /** @returns {[number, number]} */
  const sheetSize = () => [sheet.width, sheet.height];
  /** @returns {[number, number]} */
  const room = () => [canvas.width, canvas.height];
  const density = () => canvas.width / box()[0];

  function paint() {
    if (!filled) return;
    const size = pixelsOf(box(), devicePixelRatio || 1, budget);
    if (canvas.width !== size[0] || canvas.height !== size[1]) [canvas.width, canvas.height] = size;
    paintMap(context, sheet, sheetSize(), view);
    point();
  }

  function look(/** @type {import("./map_view.js").View} */ next) {
    view = next;
    paint();
  }

  async function read() {
    const map = session.map, from = player();
    if (!map || !from) return null;
    texels ??= /** @type {Texels | Promise<Texels>} */ (from.read({ path: map.path, output: map.output }));
    return (texels = await texels);
  }

  /** Choose the channel and the range by what there is in the texture. */
  async function fit() {
    fits = true;
    const map = session.map, found = await read();
    if (!map || session.map !== map || !found) return;
    const values = { ...map.values };
    for (const [name, value] of Object.entries(fitted(found))) {
      const row = session.sketch.map.shown.find(({ path }) => path.split(".").pop() === name);
      for (const leaf of row?.targets ?? []) values[leaf] = value;
    }
    session.setMap({ ...map, values });
  }

  /** Write what is under the pointer. */
  async function point() {
    readout.hidden = !session.map;
    const found = session.map && pointer ? await read() : null, map = session.map;
    if (!map) return;
    let lines = [words.pointAt];
    if (found && pointer) {
      const place = /** @type {[number, number]} */ (pointer.map((at) => at * density()));
      const at = texelAt(place, room(), view, sheetSize(), found.size), isHeight = Boolean(texture()?.height);
      const { terrain } = player()?.plan ?? session.state();
      if (at) lines = linesAt(found, at, isHeight, terrain, !isOfView(map.path), words);
    }
    readout.textContent = lines.join("\n");
  }

  return {
    fit,
    get label() { return texture()?.label ?? ""; },
    /** Show a texture, or none. @param {{path: string, output: string} | null} wanted */
    show(wanted) {
      [fits, filled, view, texels] = [false, false, WHOLE, null];
      const values = { ...session.sketch.map.values };
      session.setMap(wanted && { path: wanted.path, output: wanted.output, values });
      point();
    },
    /** The pixels at which the map is drawn; null where it follows the picture's.
     *  @returns {[number, number] | null} */
    size() {
      const { map } = session, step = map && player()?.plan?.steps?.get(map.path);
      return map && step && !isOfView(map.path) ? sheetOf(step.size) : null;
    },
    /** What was rendered is taken over; before that the map is fitted to its values.
     *  @param {Player} from @param {[number, number]} size */
    drawn(from, size) {
      texels = null;
      if (!fits) return void fit();
      [sheet.width, sheet.height] = size;
      from.drawTo(sheetContext);
      filled = true;
      paint();
    },
    /** In shares of the room's height. @param {number} across @param {number} down */
    move: (across, down) =>
      look(movedView(view, sheetSize(), room(), across * canvas.height, down * canvas.height)),
    /** Around a place in CSS pixels. @param {number} notches @param {number} x @param {number} y */
    zoom: (notches, x, y) =>
      look(zoomedView(view, sheetSize(), room(), NOTCH ** -notches, [x * density(), y * density()])),
    reset: () => look(WHOLE),
    /** The texel under a place; null outside the map. @param {[number, number]} place CSS pixels */
    texel([x, y]) {
      const { map } = session, size = map && player()?.plan?.steps?.get(map.path)?.size;
      const at = /** @type {[number, number]} */ ([x * density(), y * density()]);
      return size ? texelAt(at, room(), view, sheetSize(), size) : null;
    },
    /** @param {[number, number] | null} place CSS pixels */
    hover(place) {
      pointer = place ?? pointer;
      if (session.map) point();
    },
  };
}

// ── How many pixels a picture gets: all of the screen's at rest, fewer in a slow motion.

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
