// camera_moves.js -- what gestures make of a camera and a sun, as workbench/camera_drag.py and others.

import { orbit, pan, zoom } from "./camera.js";
import { clamp } from "./numbers.js";

/** @typedef {import("./schema.js").Camera} Camera */
/** @typedef {import("./camera.js").Eye} Eye */

/** [degrees] that a drag over the picture's whole height turns the terrain. */
const HALF_TURN = 180;
/** How much nearer one notch of the wheel brings the eye. */
export const NOTCH = 0.88;
const MAX_FIELD_OF_VIEW = 100; // [degrees] that a view is opened to at most
const MIN_SUN_ELEVATION = -10; // [degrees] of a sun, below the horizon
const DEGREE = Math.PI / 180;

/** @param {Camera} camera @param {number} across @param {number} down shares of the picture's height */
export const turned = (camera, across, down) => orbit(camera, across * HALF_TURN, down * HALF_TURN);

/** @param {Camera} camera @param {Eye} eye of the picture that is shown
 *  @param {number} field its vertical field of view
 *  @param {number} across @param {number} down */
export const moved = (camera, eye, field, across, down) => ({
  ...pan({ ...camera, field_of_view: field }, eye, -across, down),
  field_of_view: camera.field_of_view,
});

/** @param {Camera} camera @param {Eye} eye @param {number} notches nearer */
export const zoomed = (camera, eye, notches) => zoom(camera, NOTCH ** notches, eye.distance);

/** The vertical field of view that shows in a room what a picture shows from side to side.
 *  @param {number} degrees @param {[number, number]} wanted @param {[number, number]} room pixels */
export function fieldFor(degrees, wanted, room) {
  const narrower = wanted[0] / wanted[1] / (room[0] / Math.max(room[1], 1));
  if (narrower <= 1) return degrees;
  const opened = (2 * Math.atan(Math.tan((degrees * DEGREE) / 2) * narrower)) / DEGREE;
  return Math.max(degrees, Math.min(opened, MAX_FIELD_OF_VIEW));
}

/** A direction after a drag, to the right and upwards in shares of the picture's height.
 *  @param {number[]} sun azimuth, elevation @param {number} across @param {number} up
 *  @returns {[number, number]} */
export function sunMoved(sun, across, up) {
  const azimuth = (((sun[0] + across * HALF_TURN) % 360) + 360) % 360;
  return [+azimuth.toFixed(2), clamp(+(sun[1] + (up * HALF_TURN) / 2).toFixed(2), MIN_SUN_ELEVATION, 90)];
}
