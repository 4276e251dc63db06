// shapes.js -- copies textures of two dimensions into cubes, volumes, arrays and lines: engine/textures.py.
//
// WebGL has no textures of one dimension: a line is one row, which the text reads at its middle (lines.js).

import { failure } from "./context.js";

/** @typedef {import("./textures.js").Texture} Texture */

const FACES = 6;

/** What size a texture of a shape should have, "" where `size` is one.
 *  @param {string} shape @param {[number, number]} size */
function misfit(shape, [width, height]) {
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

/** @param {import("./context.js").Context} context @param {import("./textures.js").Textures} textures */
export const createShapes = ({ gl, make, limits }, textures) => {
  /** @type {Object<string, number>} */
  const targets = {
    cube: gl.TEXTURE_CUBE_MAP, volume: gl.TEXTURE_3D, layers: gl.TEXTURE_2D_ARRAY, line: gl.TEXTURE_2D,
  };
  /** The target of WebGL that a shape is bound to. @param {string} shape */
  const targetOf = (shape) => targets[shape] ?? gl.TEXTURE_2D;

  /** A copy of a texture in another shape, which is the caller's.
   *  @param {string} shape @param {Texture} source @param {boolean} levels
   *  @param {string} name what it is read as, for messages @returns {Texture} */
  const copied = (shape, source, levels, name) => {
    const wrong = misfit(shape, source.size);
    if (wrong) throw failure("sketch", `${name} reads ${source.size.join(" x ")} texels; ${wrong}`);
    const target = targetOf(shape), [width, height, deep] = shapedSize(shape, source.size);
    const { internal, bytes } = textures.formats(source.format), texture = make("Texture");
    const longest = Math.max(width, height, shape === "volume" ? deep : 1);
    const many = levels ? 1 + Math.floor(Math.log2(longest)) : 1;
    const solid = shape === "volume" || shape === "layers";
    gl.activeTexture(gl.TEXTURE0 + limits.spare);
    gl.bindTexture(target, texture);
    if (solid) gl.texStorage3D(target, many, internal, width, height, deep);
    else gl.texStorage2D(target, many, internal, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, textures.targetOf(source));
    for (let part = 0; part < (shape === "cube" ? FACES : deep); part++) {
      const from = part * height;
      const face = shape === "cube" ? gl.TEXTURE_CUBE_MAP_POSITIVE_X + part : target;
      if (solid) gl.copyTexSubImage3D(target, 0, 0, 0, part, 0, from, width, height);
      else gl.copyTexSubImage2D(face, 0, 0, 0, 0, from, width, height);
    }
    if (many > 1) gl.generateMipmap(target);
    gl.bindTexture(target, null);
    const texels = source.size[0] * source.size[1] * bytes;
    return {
      texture, size: source.size, format: source.format, levels: many,
      bytes: many > 1 ? Math.ceil((texels * 4) / 3) : texels, target: null,
    };
  };

  return { copied, targetOf };
};
