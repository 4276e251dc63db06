// formats.js -- the formats of textures: what WebGL calls them, and what one without 16-bit channels takes
// instead.

/** @typedef {object} Format
 *  @property {number} internal
 *  @property {number} external
 *  @property {number} type
 *  @property {number} channels
 *  @property {number} bytes         of a texel
 *  @property {boolean} float32
 *  @property {number} steps         a normalised format kept in floats: its steps from 0 to 1; else 0 */

/** @param {import("./context.js").Context} context @returns {(name: string) => Format} */
export const formatsOf = ({ gl, norm16 }) => {
  const any = /** @type {any} */ (gl);
  /** @type {Map<string, Format>} */
  const known = new Map();
  /** @param {string} name @returns {Format} */
  const made = (name) => {
    if (name === "srgb8") return { ...made("rgba8"), internal: gl.SRGB8_ALPHA8 };
    const [, letters, kind] = /** @type {RegExpExecArray} */ (/^([rgba]+)(\w+)$/.exec(name));
    const channels = letters.length, external = [gl.RED, gl.RG, gl.RGB, gl.RGBA][channels - 1];
    if (kind === "16" && !norm16) return { ...made(`${letters}32f`), steps: 65535 };
    const internal = kind === "16" ? /** @type {any} */ (norm16)[`${letters.toUpperCase()}16_EXT`]
      : any[letters.toUpperCase() + kind.toUpperCase()];
    const type = { 8: gl.UNSIGNED_BYTE, 16: gl.UNSIGNED_SHORT, "16f": gl.HALF_FLOAT, "32f": gl.FLOAT }[kind];
    if (!internal || !type) throw new Error(`format ${name}`);
    const bytes = (channels * parseInt(kind)) / 8;
    return { internal, external, type, channels, bytes, float32: kind === "32f", steps: 0 };
  };
  return (name) => {
    let found = known.get(name);
    if (!found) known.set(name, (found = made(name)));
    return found;
  };
};

/** Return what a kernel's fragment shader writes last where normalised formats are kept in floats.
 *  @param {{name: string, format: string}[]} outputs @param {(name: string) => Format} formats */
export const roundedOutputs = (outputs, formats) =>
  outputs.filter((output) => formats(output.format).steps).map(({ name, format }) => {
    const steps = formats(format).steps.toFixed(1);
    return ` k_out_${name} = floor(clamp(k_out_${name}, 0.0, 1.0) * ${steps} + 0.5) / ${steps};`;
  }).join("");

/** Return a format's texels as what is uploaded. @param {WebGL2RenderingContext} gl @param {Format} format
 *  @param {ArrayBuffer} bytes as Python writes them */
export const texelsOf = (gl, { type, steps }, bytes) => {
  if (steps) return Float32Array.from(new Uint16Array(bytes), (value) => value / steps);
  return new (type === gl.UNSIGNED_BYTE ? Uint8Array : type === gl.FLOAT ? Float32Array : Uint16Array)(bytes);
};
