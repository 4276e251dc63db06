// detail.js -- chooses what to draw of a mesh of which only a part is drawn: CHOOSERS of engine/lod.py.

// ── Makes the tile that all terrain in tiles is drawn with, and how to join it: engine/lod.py.
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
function isAtRim(side, j, i, ny, nx) {
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

// ── Finds which boxes around tiles a view sees, and how deep they lie: engine/lod.py.

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
function boxesOf({ size: [nx, ny], data }, view) {
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
function withWalls(boxes, view) {
  const deep = -Math.max(...view.extent);
  return { ...boxes, up: [boxes.up[0].map((each) => Math.min(each, deep)), boxes.up[1]] };
}

/** Of the first three numbers of each.
 *  @param {number[]} a @param {number[]} b */
function dot(a, b) {
  return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

// ── Gives each tile the coarsest level whose error, in pixels, is allowed: engine/lod.py.
//
// Levels of neighbours differ by one at most; tiles outside the view are left out.

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

// ── Chooses tiles that morph: squares of tiles, cut in four where they are near: engine/lod.py.
//
// Every square is drawn by the same triangles, whose vertices slide into those of the next level as the
// distance grows (view/vertices.glsl). The distance of each level is one number for the whole terrain.

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

// ── Chooses what to draw of a mesh of which only a part is drawn

/** By mesh, the inputs of the draw whose texels the choice reads; its instances have an attribute `tile`.
 *  @type {Object<string, string[]>} */
export const CHOSEN_BY = { land: ["spans", "errors"] };

/** Chooses what to draw of a mesh; a full grid is drawn whole, once. `tables` downloads what it reads.
 *  @param {string} mesh @param {Object<string, any>} values @param {() => Object<string, Table>} tables
 *  @param {View} view @returns {Chosen} */
export function choose(mesh, values, tables, view) {
  if (!(mesh in CHOSEN_BY)) throw new Error(`nothing is chosen of mesh '${mesh}'`);
  if (values.detail === 0) return { runs: [["whole 0 0", 1]], places: new Float32Array(4) };
  const { spans, errors } = tables();
  return (values.detail === 1 ? geomipmap : morph)({ tolerance: values.tolerance }, { spans, errors }, view);
}
