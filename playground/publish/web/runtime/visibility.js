// visibility.js -- finds which boxes around tiles a view sees, and how deep they lie: engine/lod.py.

export const FAR = 1e30;

/** From where, and how large, a terrain is looked at: the matrix as `look` of camera.js gives it, extent and
 *  eye [m], relief [m] of height 1, size [pixels].
 *  @typedef {{clipFromWorld: Float32Array, eye: number[], extent: number[], relief: number,
 *             size: number[]}} View */

/** What a download gives of a texture: as many numbers a texel as it has channels.
 *  @typedef {{size: number[], data: Float32Array}} Table */

/** The boxes around the tiles of a terrain [m]: columns and rows share their sides, each lower then higher.
 *  @typedef {{nx: number, ny: number, east: number[][], north: number[][],
 *             up: [Float64Array, Float64Array]}} Boxes */

/** @param {View} view @param {number} k @returns {number[]} */
function row({ clipFromWorld }, k) {
  return [clipFromWorld[k], clipFromWorld[4 + k], clipFromWorld[8 + k], clipFromWorld[12 + k]];
}

/** Depth [m] of the plane before which nothing is drawn.
 *  @param {View} view */
function near(view) {
  const ahead = row(view, 3), depth = row(view, 2);
  return -(dot(depth, view.eye) + depth[3]) / (1 + dot(depth, ahead) / dot(ahead, ahead));
}

/** The most pixels that a metre upwards is long, at depth 1 m, anywhere in the picture: in a corner.
 *  @param {View} view */
export function pixels(view) {
  const [across, upright, ahead] = [0, 1, 3].map((k) => row(view, k));
  const wide = 1 / Math.sqrt(dot(across, across)), tall = 1 / Math.sqrt(dot(upright, upright));
  const lengths = [-wide, wide].flatMap((x) => [-tall, tall].map((y) => {
    const right = (view.size[0] / (2 * wide)) * (across[2] * wide - x * ahead[2]);
    const up = (view.size[1] / (2 * tall)) * (upright[2] * tall - y * ahead[2]);
    return Math.sqrt(right * right + up * up);
  }));
  return Math.max(...lengths);
}

/** How much further than it is deep a place in the picture may be.
 *  @param {View} view */
export function stretch(view) {
  const across = row(view, 0), upright = row(view, 1);
  return Math.sqrt(1 + 1 / dot(across, across) + 1 / dot(upright, upright));
}

/** The boxes of squares: `spans` are the lowest and highest heights, and where they end, in shares of the
 *  terrain's sides, east and north; each begins where the one before ends.
 *  @param {Table} spans @param {View} view @returns {Boxes} */
export function boxesOf({ size: [nx, ny], data }, view) {
  const [east, north] = [nx, ny].map((count, axis) => {
    const edges = [0, ...Array.from({ length: count }, (_, k) => data[4 * (axis ? nx * k : k) + 2 + axis])];
    const along = edges.map((share) => share * view.extent[axis]);
    return [along.slice(0, -1), along.slice(1)];
  });
  const heights = [0, 1].map((which) => Float64Array.from({ length: nx * ny }, (_, tile) =>
    Math.min(Math.max(data[4 * tile + which], -FAR), FAR) * view.relief));
  // A relief below 0 turns the terrain upside down.
  const [low, high] = view.relief >= 0 ? heights : heights.reverse();
  return { nx, ny, east, north, up: [low, high] };
}

/** The support of each box: the most of a plane's equation at a place of it.
 *  @param {Boxes} boxes @param {number[]} plane @returns {Float64Array} */
function support({ nx, ny, east, north, up }, plane) {
  const most = (/** @type {number[][]} */ [low, high], /** @type {number} */ factor) =>
    low.map((each, k) => Math.max(factor * each, factor * high[k]));
  const across = most(east, plane[0]), along = most(north, plane[1]);
  const heights = up[plane[2] > 0 ? 1 : 0];
  const found = new Float64Array(nx * ny);
  for (let j = 0, tile = 0; j < ny; j++) {
    for (let i = 0; i < nx; i++, tile++) {
      found[tile] = plane[2] * heights[tile] + across[i] + (along[j] + plane[3]);
    }
  }
  return found;
}

/** The least depth [m] of each box that can be visible.
 *  @param {Boxes} boxes @param {View} view @returns {Float64Array} */
export function depths(boxes, view) {
  const least = near(view);
  return support(boxes, row(view, 3).map((each) => -each)).map((each) => Math.max(-each, least));
}

/** The largest that a diagonal of any box can be [m].
 *  @param {Boxes} boxes */
export function longest({ east, north, up }) {
  const [x, y, z] = [east, north, up].map(([low, high]) => {
    let most = -Infinity;
    for (let k = 0; k < low.length; k++) most = Math.max(most, high[k] - low[k]);
    return most;
  });
  return Math.sqrt(x * x + y * y + z * z);
}

/** How far [m] the eye is from each box's nearest place, and from its furthest.
 *  @param {Boxes} boxes @param {number[]} eye @returns {[Float64Array, Float64Array]} */
export function distances(boxes, eye) {
  const { nx } = boxes;
  const squares = [boxes.east, boxes.north, boxes.up].map(([low, high], axis) => {
    const at = eye[axis];
    const nearest = new Float64Array(low.length), furthest = new Float64Array(low.length);
    for (let k = 0; k < low.length; k++) {
      const within = Math.max(low[k] - at, at - high[k], 0);
      const beyond = Math.max(Math.abs(low[k] - at), Math.abs(high[k] - at));
      nearest[k] = within * within;
      furthest[k] = beyond * beyond;
    }
    return [nearest, furthest];
  });
  const [nearest, furthest] = [0, 1].map((which) => {
    const [east, north, up] = squares.map((each) => each[which]);
    return up.map((each, tile) => Math.sqrt(east[tile % nx] + north[Math.floor(tile / nx)] + each));
  });
  return [nearest, furthest];
}

/** Which boxes are not wholly outside one of the six planes of the view, 1 or 0.
 *  @param {Boxes} boxes @param {View} view @returns {Uint8Array} */
export function visible(boxes, view) {
  const found = new Uint8Array(boxes.nx * boxes.ny).fill(1);
  const ahead = row(view, 3);
  for (const k of [0, 1, 2]) {
    const side = row(view, k);
    for (const sign of [1, -1]) {
      const most = support(boxes, ahead.map((each, axis) => each + sign * side[axis]));
      most.forEach((each, tile) => { if (!(each >= 0)) found[tile] = 0; });
    }
  }
  return found;
}

/** Boxes that hold the walls at the terrain's rim as well: none goes deeper than this, or than the terrain.
 *  @param {Boxes} boxes @param {View} view @returns {Boxes} */
export function withWalls(boxes, view) {
  const deep = -Math.max(...view.extent);
  return { ...boxes, up: [boxes.up[0].map((each) => Math.min(each, deep)), boxes.up[1]] };
}

/** Of the first three numbers of each.
 *  @param {number[]} a @param {number[]} b */
function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}
