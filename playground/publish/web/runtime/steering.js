// steering.js -- what gestures over a figure change: the camera, the sun, a line between two pictures, a map.

import { fieldFor, moved, sunMoved, turned, zoomed } from "./camera_moves.js";
import { followGestures } from "./gestures.js";
import { clamp } from "./numbers.js";
import { cameraAt } from "./values.js";

/** @typedef {import("./schema.js").Camera} Camera */
/** @typedef {import("./session.js").Session} Session */
/** @typedef {import("./figure_map.js").FigureMap} FigureMap */
/** @typedef {import("./camera_moves.js").Eye} Eye */

const GRAB = 6; // [CSS pixels] from a line between two pictures

/** @param {HTMLElement} canvas @param {Session} session @param {FigureMap} map
 *  @param {{box: () => [number, number], eye: () => Eye | undefined, inText: boolean}} figure */
export function steerWith(canvas, session, map, { box, eye, inText }) {
  let held = "";
  /** Keyframes' camera goes on from where it is. @param {(now: Camera, eye: Eye) => Camera} change */
  function steer(change) {
    const from = eye(), now = cameraAt(session.sketch, session.camera, session.time);
    // Several gestures may come between two frames: the eye is that of the last frame.
    const distance = now.distance || from?.distance || 0, target = now.target ?? from?.target;
    if (from && target) session.setCamera(change(now, { ...from, distance, target }));
  }

  const turn = (/** @type {number} */ across, /** @type {number} */ down) =>
    session.map ? map.move(across, down) : steer((now) => turned(now, across, down));

  function move(/** @type {number} */ across, /** @type {number} */ down) {
    if (session.map) return map.move(across, down);
    return steer((now, from) => {
      const field = fieldFor(now.field_of_view, session.sketch.frame, box());
      return moved(now, from, field, across, down);
    });
  }

  const zoom = (/** @type {number} */ notches, x = box()[0] / 2, y = box()[1] / 2) =>
    session.map ? map.zoom(notches, x, y) : steer((now, from) => zoomed(now, from, notches));

  const resetView = () => (session.map ? map.reset() : session.setCamera(null));

  const rowsOf = (/** @type {string} */ widget) =>
    session.sketch.shown.filter((row) => row.exported && row.widget === widget && !row.locked);

  /** Take the line that is nearest to a place, if it is near. */
  function grab(/** @type {number} */ x) {
    const away = (/** @type {string} */ path) => Math.abs(Number(session.value(path)) * box()[0] - x);
    const paths = session.map ? [] : rowsOf("divider").map(({ path }) => path);
    paths.sort((a, b) => away(a) - away(b));
    held = paths.length && away(paths[0]) <= GRAB ? paths[0] : "";
    return held !== "";
  }

  /** Move the sun: every direction that the passes show, those of the view where no other has one. */
  function light(/** @type {number} */ across, /** @type {number} */ up) {
    const suns = rowsOf("direction"), terrain = suns.filter((row) => row.pass !== "view");
    /** @type {[string, number[]][]} */
    const news = (terrain.length ? terrain : suns).map(({ path }) => [
      path, sunMoved(/** @type {number[]} */ (session.value(path)), across, up),
    ]);
    if (news.length) session.setAll(news, "light");
  }

  const drag = (/** @type {number} */ x) => session.set(held, +clamp(x / box()[0]).toFixed(4));
  const wheel = () => !inText || document.activeElement === canvas;
  const meanings = { turn, move, zoom, reset: resetView, grab, drag, light, hover: map.hover };
  followGestures(canvas, meanings, { sideways: inText, wheel });
  return { turn, move, zoom, resetView };
}
