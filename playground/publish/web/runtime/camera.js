// camera.js -- turns a camera that orbits the terrain into matrices: engine/camera.py.
//
// World space: metres of the terrain, x east, y north, z up from height 0; the south-west corner is the
// origin. Matrices here have 16 numbers, row after row, and act on columns; those of an eye are as WebGL
// takes them, column after column. The same operations in the same order as Python's, so that both have the
// same matrices to the last bit.

import { clamp } from "./numbers.js";

/** @import { Camera } from "./schema.js" */

// ── Turns directions on the terrain into vectors: engine/camera.py.
//
// Sums and products alone, in the order of Python's: no two libraries of mathematics agree on the last bit
// of a sine.

const SINE = taylor(1, 9);
const COSINE = taylor(0, 10);

/** The unit vector (east, north, up) of an azimuth, clockwise from north, and an elevation [degrees].
 *  Exact at quarter turns, as glsl/lighting/sun.glsl is.
 *  @param {number[]} direction @returns {[number, number, number]} */
export function unitVector([azimuth, elevation]) {
  const [north, east] = cosSin(azimuth);
  const [level, up] = cosSin(elevation);
  return [east * level, north * level, up];
}

/** The cosine and the sine of an angle; exact at quarter turns.
 *  @param {number} degrees @returns {[number, number]} */
function cosSin(degrees) {
  const rest = degrees % 360;
  const quarters = Math.floor(rest / 90 + 0.5);
  const x = (rest - 90 * quarters) * (Math.PI / 180);
  const c = series(COSINE, x * x), s = x * series(SINE, x * x);
  switch (quarters & 3) {
    case 0: return [c, s];
    case 1: return [-s, c];
    case 2: return [-c, -s];
    default: return [s, -c];
  }
}

/** The factors of Taylor's series of a sine, of odd powers, or a cosine, of even ones.
 *  @param {number} power @param {number} count */
function taylor(power, count) {
  let factorial = 1;
  return Array.from({ length: count }, (_, n) => {
    if (n) factorial *= (2 * n + power - 1) * (2 * n + power);
    return (n % 2 ? -1 : 1) / factorial;
  });
}

/** @param {number[]} factors @param {number} x */
function series(factors, x) {
  return factors.reduceRight((sum, factor) => sum * x + factor, 0);
}

// ── Turns a camera that orbits the terrain into matrices

/** @typedef {[number, number, number]} Vector */

/** A camera over one terrain, seen in one picture. Positions in metres.
 *  @typedef {{clipFromWorld: Float32Array, worldFromClip: Float32Array, eye: Vector, target: Vector,
 *             distance: number}} Eye */

const MARGIN = 1.06; // air around a terrain that just fills the picture

/** The eye of a camera over a terrain of an extent and a relief [m], in a picture of a size [pixels].
 *  @param {Camera} camera @param {number[]} extent @param {number} relief @param {number[]} size
 *  @returns {Eye} */
export function look(camera, extent, relief, size) {
  const aspect = size[0] / size[1];
  const radius = 0.5 * length(...extent, relief);
  /** @type {Vector} */
  const target = camera.target ?? [extent[0] / 2, extent[1] / 2, relief / 2];
  const distance = camera.distance || fit(camera, extent, relief, aspect);
  const [north, east] = cosSin(camera.azimuth), [level, rise] = cosSin(camera.elevation);
  const towards = [east * level, north * level, rise]; // the eye, from the target
  /** @type {Vector} */
  const eye = [
    target[0] + distance * towards[0], target[1] + distance * towards[1], target[2] + distance * towards[2],
  ];
  const away = length(eye[0] - extent[0] / 2, eye[1] - extent[1] / 2, eye[2] - relief / 2);
  const near = Math.max(away - 1.2 * radius, 0.002 * distance, 1e-3);
  const far = away + 2 * radius;
  // At right angles to the eye's direction already, so that looking straight down is nothing special.
  const right = [-north, east, 0], up = [-east * rise, -north * rise, level];
  const high = near * halfHeight(camera); // [m] half of what is in the picture, at the near plane
  // The rows of world to view, each scaled as the lens does.
  const across = rowOf(right, 0, target, near / (high * aspect));
  const upright = rowOf(up, 0, target, near / high);
  const behind = rowOf(towards, distance, target, 1);
  const depth = behind.map((each) => each * (-(far + near) / (far - near)));
  depth[3] += -2 * far * near / (far - near);
  const matrix = [...across, ...upright, ...depth, ...behind.map((each) => -each)].map(Math.fround);
  return {
    clipFromWorld: columnsOf(matrix), worldFromClip: columnsOf(inverse(matrix)), eye, target, distance,
  };
}

/** A row that gives how far places are along an axis from the eye, which is `distance` from the target
 *  along it.
 *  @param {number[]} axis @param {number} distance @param {Vector} target @param {number} scale */
function rowOf([x, y, z], distance, target, scale) {
  const offset = -(x * target[0] + y * target[1] + z * target[2]) - distance;
  return [x * scale, y * scale, z * scale, offset * scale];
}

/** Half the height of what is in the picture, over its depth.
 *  @param {Camera} camera */
function halfHeight(camera) {
  const [cosine, sine] = cosSin(camera.field_of_view / 2);
  return sine / cosine;
}

/** The distance [m] from the terrain's middle at which all of it is in the picture, whatever the azimuth:
 *  Python's docstring derives it.
 *  @param {Camera} camera @param {number[]} extent @param {number} relief @param {number} aspect */
export function fit(camera, extent, relief, aspect) {
  const radius = length(...extent) / 2, up = relief / 2;
  const tall = halfHeight(camera);
  const [cosine, sine] = cosSin(camera.elevation);
  const sideways = radius * length(cosine, 1 / (tall * aspect)) + up * Math.abs(sine);
  const upwards = Math.max(...[-1, 1].map((sign) =>
    radius * Math.abs(cosine + sign * sine / tall) + up * Math.abs(sine - sign * cosine / tall)));
  return Math.max(MARGIN * Math.max(sideways, upwards), 1e-2);
}

/** The camera turned by so many degrees; the eye stays 89 degrees or less from the horizon.
 *  @param {Camera} camera @param {number} azimuth @param {number} elevation @returns {Camera} */
export function orbit(camera, azimuth, elevation) {
  const turned = (camera.azimuth + azimuth) % 360;
  return {
    ...camera,
    azimuth: (turned < 0 ? 360 : 0) + turned,
    elevation: Math.min(Math.max(camera.elevation + elevation, -89), 89),
  };
}

/** The camera `factor` times as far from its target as `distance` metres.
 *  @param {Camera} camera @param {number} factor @param {number} distance @returns {Camera} */
export function zoom(camera, factor, distance) {
  return { ...camera, distance: Math.min(Math.max(distance * factor, 1e-2), 1e8) };
}

/** The camera moved over the terrain: `right`, and `up` along the ground, in shares of the picture's height.
 *  @param {Camera} camera @param {Eye} eye @param {number} right @param {number} up @returns {Camera} */
export function pan(camera, eye, right, up) {
  const [cosine, sine] = cosSin(camera.azimuth);
  const scale = 2 * eye.distance * halfHeight(camera);
  // The picture's right is a quarter turn counter-clockwise from the eye's place, seen from above.
  const east = -cosine * right - sine * up;
  const north = sine * right - cosine * up;
  const [x, y, z] = eye.target;
  return { ...camera, target: [x + scale * east, y + scale * north, z] };
}

/** By elimination, each column's pivot its largest number.
 *  @param {number[]} matrix @returns {number[]} */
function inverse(matrix) {
  const four = [0, 1, 2, 3];
  const rows = four.map((i) => [...matrix.slice(4 * i, 4 * i + 4), ...four.map((j) => Number(i === j))]);
  for (let column = 0; column < 4; column++) {
    let pivot = column;
    for (let row = column + 1; row < 4; row++) {
      if (Math.abs(rows[row][column]) > Math.abs(rows[pivot][column])) pivot = row;
    }
    [rows[column], rows[pivot]] = [rows[pivot], rows[column]];
    for (let row = column + 1; row < 4; row++) {
      const factor = rows[row][column] / rows[column][column];
      for (let k = column; k < 8; k++) rows[row][k] -= factor * rows[column][k];
    }
  }
  for (let row = 3; row >= 0; row--) {
    for (let k = 4; k < 8; k++) {
      for (let later = row + 1; later < 4; later++) rows[row][k] -= rows[row][later] * rows[later][k];
      rows[row][k] /= rows[row][row];
    }
  }
  return rows.flatMap((row) => row.slice(4));
}

/** @param {number[]} matrix */
function columnsOf(matrix) {
  return Float32Array.from(matrix, (_, at) => matrix[4 * (at % 4) + Math.floor(at / 4)]);
}

/** @param {number[]} parts */
function length(...parts) {
  return Math.sqrt(parts.reduce((sum, part) => sum + part * part, 0));
}

// ── What gestures make of a camera and a sun, as playground/studio/picture/gestures.py.

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
