// morph.js -- chooses tiles that morph: squares of tiles, cut in four where they are near: engine/lod.py.
//
// Every square is drawn by the same triangles, whose vertices slide into those of the next level as the
// distance grows (view/vertices.glsl). The distance of each level is one number for the whole terrain.

import { CELLS, LEVELS, SIDES, isAtRim } from "./tiles.js";
import { FAR, boxesOf, distances, longest, pixels, stretch, visible, withWalls } from "./visibility.js";

/** @typedef {import("./visibility.js").View} View */
/** @typedef {import("./visibility.js").Boxes} Boxes */
/** @typedef {import("./visibility.js").Table} Table */
/** @typedef {import("./tiles.js").Chosen} Chosen */

// Where vertices begin to slide, over a level's distance: MORPH_START in view/vertices.glsl.
const START = 0.8;
// From where on a box counts, over the distance at which it needs a finer level.
const NEARLY = 0.8;

/** Chooses squares of a quadtree in the view, each cut in four where its children are drawn.
 *  @param {{tolerance: number}} values @param {{spans: Table, errors: Table}} tables @param {View} view
 *  @returns {Chosen} */
export function morph({ tolerance }, tables, view) {
  const squares = pyramid(tables.spans);
  const ends = levelDistances(tables, squares, view, tolerance);
  /** @type {Map<string, number[]>} */
  const found = new Map([["fans 0 0", []]]);
  for (const quarter of ["0 0", "0 1", "1 0", "1 1"]) found.set(`quarter ${quarter}`, []);
  for (const side of SIDES) found.set(`wall 0 ${side}`, []);
  let inside = new Uint8Array(1).fill(1);
  for (let level = squares.length - 1; level >= 0; level--) {
    const boxes = boxesOf(squares[level], view);
    const { nx, ny } = boxes;
    const [away] = distances(boxes, view.eye);
    const seen = visible(boxes, view), walled = visible(withWalls(boxes, view), view);
    const cut = inside.map((each, square) => Number(each && level > 0 && away[square] < ends[level - 1]));
    inside.forEach((each, square) => {
      if (!each || cut[square]) return;
      const i = square % nx, j = Math.floor(square / nx);
      const place = (/** @type {string} */ piece, /** @type {number} */ shown) => {
        const side = CELLS * 2 ** shown, up = shown - level;
        const end = ends[Math.min(shown, ends.length - 1)];
        found.get(piece)?.push(side * (i >> up), side * (j >> up), shown, end);
      };
      if (seen[square] && away[square] < ends[level]) place("fans 0 0", level);
      // What has become its parent's quarter altogether, and is drawn as that.
      else if (seen[square]) place(`quarter ${i % 2} ${j % 2}`, level + 1);
      for (const side of SIDES) {
        if (walled[square] && isAtRim(side, j, i, ny, nx)) place(`wall 0 ${side}`, level);
      }
    });
    if (level) inside = children(cut, nx, squares[level - 1].size);
  }
  return {
    runs: [...found].map(([piece, places]) => [piece, places.length / 4]),
    places: Float32Array.from([...found.values()].flat()),
  };
}

/** The spans of squares of 1, 2, 4 ... tiles a side, up to one square: see `boxesOf`.
 *  @param {Table} spans @returns {Table[]} */
function pyramid(spans) {
  const found = [spans];
  for (let last = spans; Math.max(...last.size) > 1; last = found[found.length - 1]) {
    const [wide, tall] = last.size;
    const [nx, ny] = last.size.map((count) => Math.ceil(count / 2));
    const data = new Float32Array(4 * nx * ny);
    for (let square = 0; square < nx * ny; square++) {
      const i = 2 * (square % nx), j = 2 * Math.floor(square / nx);
      const four = [j, Math.min(j + 1, tall - 1)].flatMap((row) =>
        [i, Math.min(i + 1, wide - 1)].map((column) => 4 * (row * wide + column)));
      data[4 * square] = Math.min(...four.map((at) => last.data[at]));
      for (const k of [1, 2, 3]) data[4 * square + k] = Math.max(...four.map((at) => last.data[at + k]));
    }
    found.push({ size: [nx, ny], data });
  }
  return found;
}

/** The distance [m] up to which each level of morphing tiles is drawn; the last has no end.
 *
 *  The next level shows through from `START` of it on, and must be within `tolerance` pixels there. A level
 *  is also drawn so far that the next one lies wholly within its own unmorphed part wherever the two meet.
 *  @param {{errors: Table}} tables @param {Table[]} squares @param {View} view
 *  @param {number} tolerance @returns {number[]} */
function levelDistances({ errors }, squares, view, tolerance) {
  const pixel = Math.abs(view.relief) * pixels(view) * stretch(view) / Math.max(tolerance, 1e-9);
  const boxes = squares.map((each) => boxesOf(each, view));
  /** @type {number[]} */
  const found = [];
  for (let level = 1; level < squares.length; level++) {
    const size = Math.max(level - LEVELS + 1, 0); // of the squares whose errors are known
    const { data } = squares[size];
    const fine = Float64Array.from({ length: data.length / 4 }, (_, square) => {
      if (level >= LEVELS) return (data[4 * square + 1] - data[4 * square]) * pixel;
      const error = errors.data[4 * square + level - 1];
      return (error < FAR / 2 ? error : 0) * pixel; // holes may change their shape
    });
    const wanted = furthest(boxes[size], fine, view);
    // The tile before was cut because its parent is near: its points may be a parent's size further.
    const within = found.length ? (found[found.length - 1] + longest(boxes[level - 1])) * 1.02 : 0;
    found.push(Math.min(Math.max(wanted, within) / START, FAR));
  }
  return [...found, FAR];
}

/** The distance up to which some box needs a finer level, each for itself up to `fine`. A box that lies
 *  wholly beyond that needs none; it comes in little by little, so that nothing jumps.
 *  @param {Boxes} boxes @param {Float64Array} fine @param {View} view */
function furthest(boxes, fine, view) {
  const [near, far] = distances(boxes, view.eye);
  return fine.reduce((most, each, box) => {
    const share = (each - NEARLY * near[box]) / Math.max((1 - NEARLY) * near[box], 1e-9);
    return Math.max(most, Math.min(each, far[box]) * Math.min(Math.max(share, 0), 1));
  }, -Infinity);
}

/** Which squares of a size lie in those, twice as large, that are cut.
 *  @param {Uint8Array} cut @param {number} nx @param {number[]} size */
function children(cut, nx, [wide, tall]) {
  return Uint8Array.from({ length: wide * tall }, (_, square) =>
    cut[(Math.floor(square / wide) >> 1) * nx + (square % wide >> 1)]);
}
