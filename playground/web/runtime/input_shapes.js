// input_shapes.js -- how textures of two dimensions hold cubes, volumes, arrays and lines: gpu/shapes.py.

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
