// geomipmap.js -- gives each tile the coarsest level whose error, in pixels, is allowed: engine/lod.py.
//
// Levels of neighbours differ by one at most; tiles outside the view are left out.

import { CELLS, EAST, LEVELS, NORTH, SIDES, SOUTH, WEST, isAtRim } from "./tiles.js";
import { boxesOf, depths, pixels, visible, withWalls } from "./visibility.js";

/** @typedef {import("./visibility.js").View} View */
/** @typedef {import("./visibility.js").Boxes} Boxes */
/** @typedef {import("./visibility.js").Table} Table */
/** @typedef {import("./tiles.js").Chosen} Chosen */

/** Chooses tiles in the view, each at the coarsest level within `tolerance` pixels.
 *
 *  Of `spans` see `boxesOf`, of `errors` a texel is those of levels 1 to 4 in heights.
 *  @param {{tolerance: number}} values @param {{spans: Table, errors: Table}} tables @param {View} view
 *  @returns {Chosen} */
export function geomipmap({ tolerance }, { spans, errors }, view) {
  const boxes = boxesOf(spans, view);
  const { nx, ny } = boxes;
  const levels = levelsOf(errors, boxes, view, tolerance);
  const seen = visible(boxes, view), walled = visible(withWalls(boxes, view), view);
  const sides = sidesOf(levels, nx, ny);
  const found = [gathered("fans", levels, nx, (tile) => (seen[tile] ? sides[tile] : -1))];
  for (const side of SIDES) {
    found.push(gathered("wall", levels, nx, (tile) => (
      walled[tile] && isAtRim(side, Math.floor(tile / nx), tile % nx, ny, nx) ? side : -1)));
  }
  return {
    runs: found.flatMap(({ runs }) => runs),
    places: Float32Array.from(found.flatMap(({ places }) => places)),
  };
}

/** Each tile's level: the coarsest of at most `tolerance` pixels, neighbours one apart at most.
 *  @param {Table} errors @param {Boxes} boxes @param {View} view @param {number} tolerance */
function levelsOf(errors, boxes, view, tolerance) {
  const { nx, ny } = boxes;
  const most = Math.abs(view.relief) * pixels(view);
  let levels = Int8Array.from(depths(boxes, view), (depth, tile) => {
    const scale = most / depth;
    let level = 0;
    for (let k = 0; k < LEVELS - 1; k++) level += Number(errors.data[4 * tile + k] * scale <= tolerance);
    return level;
  });
  for (let time = 0; time < LEVELS - 1; time++) {
    const before = levels;
    levels = before.map((level, tile) => {
      let finest = level;
      if (tile >= nx) finest = Math.min(finest, before[tile - nx] + 1);
      if (tile < nx * (ny - 1)) finest = Math.min(finest, before[tile + nx] + 1);
      if (tile % nx) finest = Math.min(finest, before[tile - 1] + 1);
      if ((tile + 1) % nx) finest = Math.min(finest, before[tile + 1] + 1);
      return finest;
    });
  }
  return levels;
}

/** For each tile, the sides whose neighbours are coarser; of the last level, how it is cut: four tiles in a
 *  square make a fan.
 *  @param {Int8Array} levels @param {number} nx @param {number} ny */
function sidesOf(levels, nx, ny) {
  return levels.map((level, tile) => {
    const i = tile % nx, j = Math.floor(tile / nx);
    if (level === LEVELS - 1) return (i + j) % 2;
    return (j > 0 && levels[tile - nx] > level ? SOUTH : 0)
      | (j < ny - 1 && levels[tile + nx] > level ? NORTH : 0)
      | (i > 0 && levels[tile - 1] > level ? WEST : 0)
      | (i < nx - 1 && levels[tile + 1] > level ? EAST : 0);
  });
}

/** The wanted tiles, those of one piece after another; `sideOf` one that is not wanted is -1.
 *  @param {string} kind @param {Int8Array} levels @param {number} nx
 *  @param {(tile: number) => number} sideOf */
function gathered(kind, levels, nx, sideOf) {
  /** @type {Map<number, number[]>} */
  const byCode = new Map();
  levels.forEach((level, tile) => {
    const side = sideOf(tile);
    if (side < 0) return;
    const code = level * 16 + side;
    if (!byCode.has(code)) byCode.set(code, []);
    byCode.get(code)?.push(CELLS * (tile % nx), CELLS * Math.floor(tile / nx), level, side);
  });
  const sorted = [...byCode].sort(([one], [other]) => one - other);
  /** @type {[string, number][]} */
  const runs = sorted.map(([code, places]) => [`${kind} ${code >> 4} ${code & 15}`, places.length / 4]);
  return { runs, places: sorted.flatMap(([, places]) => places) };
}
