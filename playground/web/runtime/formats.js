// formats.js -- the formats of textures: what WebGL calls them, and what one without 16-bit channels takes instead.

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
    return { internal, external, type, channels, bytes: (channels * parseInt(kind)) / 8, float32: kind === "32f", steps: 0 };
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

const numbers = new Float32Array(1), bits = new Uint32Array(numbers.buffer);

/** Return a number as 16-bit float, rounded to even; no more than the largest.
 *  @param {number} value */
export const half = (value) => {
  numbers[0] = Math.max(-65504, Math.min(65504, value));
  const [all] = bits, sign = (all >>> 16) & 0x8000, exponent = (all >>> 23) & 255;
  if (exponent === 255) return sign | 0x7e00; // not a number
  if (exponent < 102) return sign;
  const whole = (all & 0x7fffff) | 0x800000, shift = exponent < 113 ? 126 - exponent : 13;
  const low = whole >>> shift, rest = whole & ((1 << shift) - 1), middle = 1 << (shift - 1);
  const up = rest > middle || (rest === middle && low & 1) ? 1 : 0;
  return sign | ((exponent < 113 ? low : low - 1024 + ((exponent - 112) << 10)) + up);
};

/** Return floats as what a format's texels are written as.
 *  @param {Format} format @param {Float32Array} values @param {WebGL2RenderingContext} gl */
export const texelsOf = (format, values, gl) => {
  /** @param {number} top @returns {(value: number) => number} */
  const rounded = (top) => (value) => even(Math.fround(Math.max(0, Math.min(1, value || 0)) * top));
  if (format.type === gl.UNSIGNED_BYTE) return Uint8Array.from(values, rounded(255));
  if (format.type === gl.UNSIGNED_SHORT) return Uint16Array.from(values, rounded(65535));
  if (format.type === gl.HALF_FLOAT) return Uint16Array.from(values, half);
  return format.steps ? values.map((value) => rounded(format.steps)(value) / format.steps) : values;
};

/** Round to the nearest whole number, halves to the even one.
 *  @param {number} value */
const even = (value) => {
  const low = Math.floor(value), rest = value - low;
  return rest > 0.5 || (rest === 0.5 && low % 2) ? low + 1 : low;
};
