// input_shapes.js -- how 2D textures hold cubes, volumes, arrays and lines: engine/textures.py.

import { planError } from "./expressions.js";
import { isRef } from "./plan_nodes.js";

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./schema.js").Leaf} Leaf */

const FACES = 6;

/** What size a texture of a shape should have, "" where `size` is one.
 *  @param {string} shape @param {[number, number]} size */
export function misfit(shape, [width, height]) {
  if (shape === "cube" && height !== FACES * width) {
    return `a cube map is six faces above each other, 1 : 6, as ${width} x ${FACES * width}`;
  }
  if (shape === "volume" && height !== width * width) {
    return `a volume of n texels a side is n slices above each other, as ${width} x ${width * width}`;
  }
  if (shape === "layers" && height % width) {
    const tall = Math.max(Math.floor(height / width), 1) * width;
    return `an array is square layers above each other, as ${width} x ${tall}`;
  }
  return "";
}

/** A shape's own size in texels, by the size of the texture that holds it.
 *  @param {string} shape @param {[number, number]} size @returns {[number, number, number]} */
export function shapedSize(shape, [width, height]) {
  if (!shape) return [width, height, 1];
  const deep = shape === "volume" ? width : shape === "layers" ? Math.floor(height / width) : 1;
  return [width, shape === "line" ? 1 : width, deep];
}

/** Refuse what is wired to a cube map, a volume or an array and cannot be one.
 *  @param {Sketch} sketch @param {Leaf} leaf
 *  @param {(source: import("./schema.js").Source) => [number, number]} sizeOf */
export function checkShapes(sketch, leaf, sizeOf) {
  const shapes = new Map(sketch.kernels[leaf.kernel].inputs.map((input) => [input.name, input.shape]));
  for (const [name, source] of leaf.inputs) {
    const shape = shapes.get(name);
    if (!source || !shape) continue;
    const { path } = isRef(source) ? source : fedBy(sketch.nodes, source);
    const size = sizeOf(source), wrong = misfit(shape, size);
    if (wrong) {
      const message = `${name} reads '${path}', ${size[0]} x ${size[1]} texels; ${wrong}`;
      throw planError(`pass '${leaf.path}': ${message}`, sketch.passes[leaf.path.split(".")[0]].where);
    }
  }
}

/** The texture that a loop feeds back under a name.
 *  @param {import("./schema.js").Node[]} nodes @param {{loop: string, name: string}} fed
 *  @returns {{path: string, output: string}} */
function fedBy(nodes, fed) {
  for (const node of nodes) {
    if (!("loop" in node)) continue;
    const own = node.path === fed.loop && node.feedback.find(([name]) => name === fed.name);
    if (own) return own[2];
    if (fed.loop.startsWith(`${node.path}.`)) return fedBy(node.body, fed);
  }
  throw new Error(`no loop ${fed.loop}`);
}
