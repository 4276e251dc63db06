// tiles.js -- makes the tile that all terrain in tiles is drawn with, and how to join it: engine/lod.py.
//
// A tile is 16 by 16 cells. One set of 17 by 17 vertices serves every tile at every level; each level has a
// list of indices for each set of neighbours that are one level coarser.

export const CELLS = 16;
export const LEVELS = 5;
export const SOUTH = 1, EAST = 2, NORTH = 4, WEST = 8;
export const SIDES = [SOUTH, EAST, NORTH, WEST];
const ROW = CELLS + 1; // nodes from one to the next in the north
const RING = [[-1, -1], [0, -1], [1, -1], [1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0]];

/** The name of a list: "fans", level, sides where the neighbour is coarser; "quarter" of the finest level,
 *  east or not, north or not; "wall", level, side; "whole 0 0". Of the last level's fans 0 is cut from its
 *  south-west to its north-east, 1 the other way.
 *  @typedef {string} Piece */

/** What to draw: pieces, each with how many of the places it takes, one after another; of a place the node
 *  of its south-west corner, its level, its sides or its distance [m].
 *  @typedef {{runs: [Piece, number][], places: Float32Array}} Chosen */

/** A tile's vertices: node east and north, 0 to 16, and 0, then its four sides' feet.
 *  @returns {Float32Array} */
export function vertices() {
  const top = Array.from({ length: ROW * ROW }, (_, node) => [node % ROW, Math.floor(node / ROW), 0]);
  const feet = SIDES.flatMap((side) => sideNodes(side, 1)).map((node) => [top[node][0], top[node][1], 1]);
  return Float32Array.from([...top, ...feet].flat());
}

/** @type {Map<Piece, number[]> | undefined} */
let known;

/** Every list of indices, three a triangle, counter-clockwise from above or outside.
 *  @returns {Map<Piece, number[]>} */
export function pieces() {
  if (known) return known;
  known = new Map();
  for (let level = 0; level < LEVELS - 1; level++) {
    for (let sides = 0; sides < 16; sides++) known.set(`fans ${level} ${sides}`, fans(level, sides));
  }
  const [southWest, southEast, northEast, northWest] = [0, CELLS, ROW * ROW - 1, CELLS * ROW];
  known.set(`fans ${LEVELS - 1} 0`, [southWest, southEast, northEast, southWest, northEast, northWest]);
  known.set(`fans ${LEVELS - 1} 1`, [southWest, southEast, northWest, southEast, northEast, northWest]);
  for (const east of [0, 1]) {
    for (const north of [0, 1]) known.set(`quarter ${east} ${north}`, fans(0, 0, [east, north]));
  }
  for (let level = 0; level < LEVELS; level++) {
    for (const side of SIDES) known.set(`wall ${level} ${side}`, wall(level, side));
  }
  return known;
}

/** Where each piece begins when all are one after another: its first index, and how many.
 *  @returns {Map<Piece, [number, number]>} */
export function ranges() {
  let first = 0;
  return new Map([...pieces()].map(([piece, { length }]) => {
    first += length;
    return [piece, [first - length, length]];
  }));
}

/** Whether a tile is at a side of a terrain of ny by nx tiles.
 *  @param {number} side @param {number} j @param {number} i @param {number} ny @param {number} nx */
export function isAtRim(side, j, i, ny, nx) {
  switch (side) {
    case SOUTH: return j === 0;
    case EAST: return i === nx - 1;
    case NORTH: return j === ny - 1;
    default: return i === 0;
  }
}

/** Every so many nodes of a side, in the order in which the tile is to their left.
 *  @param {number} side @param {number} step @returns {number[]} */
function sideNodes(side, step) {
  const nodes = [];
  for (let along = 0; along <= CELLS; along += step) {
    if (side === SOUTH) nodes.push(along);
    else if (side === EAST) nodes.push(CELLS + along * ROW);
    else if (side === NORTH) nodes.push(CELLS * ROW + CELLS - along);
    else nodes.push((CELLS - along) * ROW);
  }
  return nodes;
}

/** A level's triangles: fans around the middles of blocks of two by two quads.
 *  @param {number} level @param {number} coarser @param {[number, number]} [quarter] @returns {number[]} */
function fans(level, coarser, quarter) {
  const half = 1 << level;
  /** @type {number[]} */
  const found = [];
  for (let north = half; north < CELLS; north += 2 * half) {
    for (let east = half; east < CELLS; east += 2 * half) {
      const inQuarter = quarter?.every((part, axis) => (2 * [east, north][axis] >= CELLS) === Boolean(part));
      if (inQuarter === false) continue;
      const around = RING.map(([x, y]) => [east + half * x, north + half * y]);
      SIDES.forEach((side, k) => {
        const axis = side === SOUTH || side === NORTH ? 1 : 0;
        const rim = side === SOUTH || side === WEST ? 0 : CELLS;
        // The neighbour's edge has no node in the middle of this block's.
        if (coarser & side && around[2 * k + 1][axis] === rim) around[2 * k + 1] = around[2 * k];
      });
      const ring = around.map(([x, y]) => y * ROW + x);
      ring.forEach((node, k) => {
        const after = ring[(k + 1) % ring.length];
        if (node !== after) found.push(north * ROW + east, node, after);
      });
    }
  }
  return found;
}

/** The wall from a side down to its feet.
 *  @param {number} level @param {number} side @returns {number[]} */
function wall(level, side) {
  const step = 1 << level;
  const top = sideNodes(side, step);
  const foot = top.map((_, k) => ROW * ROW + SIDES.indexOf(side) * ROW + k * step);
  return top.slice(1).flatMap((next, k) => [top[k], foot[k], foot[k + 1], top[k], foot[k + 1], next]);
}
