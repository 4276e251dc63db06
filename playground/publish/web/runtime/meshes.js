// meshes.js -- builds the meshes that draws may ask for, by name: engine/meshes.py.

import { pieces, vertices } from "./tiles.js";

/** Vertices, attribute by attribute with so many numbers each, and how to join them, three a triangle.
 *  @typedef {{attributes: Object<string, {size: number, data: Float32Array}>, indices: Uint32Array}} Mesh */

/** @typedef {Object<string, number>} Values */

const DETAILS = 3; // full grid, geomipmap, morph

/** What builds a mesh, and the draw's parameters that it reads with their least and greatest.
 *  @type {Object<string, {build: (values: Values) => Mesh, reads: Object<string, [number, number]>}>} */
const MESHES = {
  grid: { build: ({ grid }) => skirted(grid), reads: { grid: [2, 4097] } },
  sheet: { build: sheet, reads: {} },
  triangles: { build: ({ count }) => triangles(count), reads: { count: [1, 2 ** 20] } },
  land: {
    build: ({ detail, grid }) => (detail === 0 ? skirted(grid) : tile()),
    reads: { detail: [0, DETAILS - 1], grid: [2, 4097] },
  },
};

/** What a mesh is known by: its name and the parameters that it depends on.
 *  Throws where one is missing or out of range.
 *  @param {string} name @param {Object<string, any>} values @returns {string} */
export function meshKey(name, values) {
  const mesh = MESHES[name];
  if (!mesh) throw new Error(`there is no mesh '${name}'`);
  const found = Object.entries(mesh.reads).map(([parameter, [low, high]]) => {
    const value = values[parameter];
    if (!Number.isInteger(value)) {
      const other = parameter === "count" ? ', or count = "…" in its #pragma' : "";
      throw new Error(`mesh '${name}' needs a parameter 'uniform int ${parameter}'${other}`);
    }
    if (value < low || value > high) {
      throw new Error(`${parameter} = ${value}: mesh '${name}' takes ${low} to ${high}`);
    }
    return `${parameter} ${value}`;
  });
  return [name, ...found].join(", ");
}

/** Builds a mesh of values that `meshKey` takes. Attribute `corner`: east and north, 0 to 1, and 0 on the
 *  terrain or 1 at a skirt's foot; of a tile nodes, 0 to 16; of triangles which one, which vertex, and 0.
 *  @param {string} name @param {Object<string, any>} values @returns {Mesh} */
export function buildMesh(name, values) {
  return MESHES[name].build(values);
}

/** A square of n by n vertices with a skirt around it.
 *  @param {number} n @returns {Mesh} */
function skirted(n) {
  const rim = rimOf(n);
  const data = new Float32Array(3 * (n * n + rim.length));
  const step = 1 / (n - 1);
  const along = Float32Array.from({ length: n }, (_, i) => (i === n - 1 ? 1 : i * step));
  for (let j = 0, at = 0; j < n; j++) {
    for (let i = 0; i < n; i++, at += 3) {
      data[at] = along[i];
      data[at + 1] = along[j];
    }
  }
  const indices = new Uint32Array(6 * ((n - 1) * (n - 1) + rim.length));
  let at = 0;
  for (let j = 0; j < n - 1; j++) {
    for (let i = 0; i < n - 1; i++, at += 6) {
      const a = j * n + i, c = a + n + 1;
      indices.set([a, a + 1, c, a, c, a + n], at);
    }
  }
  rim.forEach((top, k) => {
    const next = (k + 1) % rim.length, low = n * n + k;
    data.set([data[3 * top], data[3 * top + 1], 1], 3 * low);
    indices.set([top, low, n * n + next, top, n * n + next, rim[next]], at);
    at += 6;
  });
  return { attributes: { corner: { size: 3, data } }, indices };
}

/** The vertices at the rim of a grid: along the south, up the east, back along the north, down the west.
 *  @param {number} n @returns {number[]} */
function rimOf(n) {
  const sides = Array.from({ length: n - 1 }, (_, k) => k);
  return [
    ...sides, ...sides.map((k) => k * n + n - 1), ...sides.map((k) => n * n - 1 - k),
    ...sides.map((k) => (n - 1 - k) * n),
  ];
}

/** @returns {Mesh} */
function sheet() {
  const data = new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
  return { attributes: { corner: { size: 3, data } }, indices: new Uint32Array([0, 1, 2, 0, 2, 3]) };
}

/** Triangles whose vertices share nothing.
 *  @param {number} count @returns {Mesh} */
function triangles(count) {
  const data = new Float32Array(9 * count);
  for (let vertex = 0; vertex < 3 * count; vertex++) {
    data[3 * vertex] = Math.floor(vertex / 3);
    data[3 * vertex + 1] = vertex % 3;
  }
  const indices = Uint32Array.from({ length: 3 * count }, (_, vertex) => vertex);
  return { attributes: { corner: { size: 3, data } }, indices };
}

/** One tile with every list of indices, one after another.
 *  @returns {Mesh} */
function tile() {
  const indices = Uint32Array.from([...pieces().values()].flat());
  return { attributes: { corner: { size: 3, data: vertices() } }, indices };
}
