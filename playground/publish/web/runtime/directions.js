// directions.js -- turns directions on the terrain into vectors: engine/camera.py.
//
// Sums and products alone, in the order of Python's: no two libraries of mathematics agree on the last bit
// of a sine.

const SINE = taylor(1, 9);
const COSINE = taylor(0, 10);

/** The unit vector (east, north, up) of an azimuth, clockwise from north, and an elevation [degrees].
 *  Exact at quarter turns, as glsl/lighting/sun.glsl is.
 *  @param {number[]} direction @returns {[number, number, number]} */
export function unitVector([azimuth, elevation]) {
  const [north, east] = cosSin(azimuth);
  const [level, up] = cosSin(elevation);
  return [east * level, north * level, up];
}

/** The cosine and the sine of an angle; exact at quarter turns.
 *  @param {number} degrees @returns {[number, number]} */
export function cosSin(degrees) {
  const rest = degrees % 360;
  const quarters = Math.floor(rest / 90 + 0.5);
  const x = (rest - 90 * quarters) * (Math.PI / 180);
  const c = series(COSINE, x * x), s = x * series(SINE, x * x);
  switch (quarters & 3) {
    case 0: return [c, s];
    case 1: return [-s, c];
    case 2: return [-c, -s];
    default: return [s, -c];
  }
}

/** The factors of Taylor's series of a sine, of odd powers, or a cosine, of even ones.
 *  @param {number} power @param {number} count */
function taylor(power, count) {
  let factorial = 1;
  return Array.from({ length: count }, (_, n) => {
    if (n) factorial *= (2 * n + power - 1) * (2 * n + power);
    return (n % 2 ? -1 : 1) / factorial;
  });
}

/** @param {number[]} factors @param {number} x */
function series(factors, x) {
  return factors.reduceRight((sum, factor) => sum * x + factor, 0);
}
