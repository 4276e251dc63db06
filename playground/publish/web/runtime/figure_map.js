// figure_map.js -- a figure while it shows a texture from above: what is drawn, moved and read.

import {
  WHOLE, fitted, isOfView, linesAt, movedView, paintMap, sheetOf, texelAt, zoomedView,
} from "./map_view.js";
import { NOTCH } from "./camera_moves.js";
import { pixelsOf } from "./quality.js";

/** @typedef {import("./figure.js").Player} Player */
/** @typedef {import("./session.js").Session} Session */
/** @typedef {import("./map_view.js").Texels} Texels */
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
    /** @param {[number, number] | null} place CSS pixels */
    hover(place) {
      pointer = place ?? pointer;
      if (session.map) point();
    },
  };
}
