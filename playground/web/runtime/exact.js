// exact.js -- arithmetic of whole numbers, fractions and floats, as Python has it.
//
// A whole number is a bigint, a number with a fraction is a number, as 2 ** -1 and 1 / 3 are of whole
// numbers an exact fraction. Where one of two is a float, the other becomes one.

/** @typedef {{n: bigint, d: bigint}} Fraction  in lowest terms, d > 1 */
/** @typedef {bigint | number | Fraction} Exact */

/** @param {bigint} value */
const abs = (value) => (value < 0n ? -value : value);

/** @param {bigint} value @returns {number} binary digits */
export const bitLength = (value) => (value ? abs(value).toString(2).length : 0);

/** @param {bigint} n @param {bigint} d */
const floorDivided = (n, d) => n / d - (n % d !== 0n && n < 0n !== d < 0n ? 1n : 0n);

/** @param {bigint} n @param {bigint} d not 0 @returns {bigint | Fraction} */
function reduced(n, d) {
  let [a, b] = [abs(n), abs(d)];
  while (b) [a, b] = [b, a % b];
  if (d < 0n) a = -a;
  return d === a ? n / a : { n: n / a, d: d / a };
}

/** The exact fraction that a number is.
 *  @param {Exact} value @returns {Fraction} */
function ratio(value) {
  if (typeof value === "bigint") return { n: value, d: 1n };
  if (typeof value !== "number") return value;
  let d = 1n;
  while (!Number.isInteger(value)) [value, d] = [value * 2, d * 2n];
  return { n: BigInt(value), d };
}

/** The nearest float, of two as near the even one.
 *  @param {Exact} value */
export function float(value) {
  if (typeof value !== "object") return Number(value);
  // So many binary digits of the quotient that a last one, for what was cut off, rounds them rightly.
  const shift = BigInt(Math.max(bitLength(value.d) - bitLength(value.n) + 66, 0)), n = abs(value.n) << shift;
  const found = Number((n / value.d) | (n % value.d ? 1n : 0n)) * 2 ** -Number(shift);
  return value.n < 0n ? -found : found;
}

/** Quotient rounded down and remainder of floats, the remainder with the divisor's sign.
 *  @param {number} a @param {number} b @returns {[number, number]} */
function divided(a, b) {
  let rest = a % b, whole = (a - rest) / b;
  if (rest && b < 0 !== rest < 0) [rest, whole] = [rest + b, whole - 1];
  else if (!rest) rest = b < 0 ? -0 : 0;
  const floor = Math.floor(whole);
  return [whole ? floor + (whole - floor > 0.5 ? 1 : 0) : a / b < 0 ? -0 : 0, rest];
}

/** @type {Object<string, (a: number, b: number) => number>} */
const FLOATS = {
  "+": (a, b) => a + b,
  "-": (a, b) => a - b,
  "*": (a, b) => a * b,
  "/": (a, b) => a / b,
  "//": (a, b) => divided(a, b)[0],
  "%": (a, b) => divided(a, b)[1],
};

/** @type {Object<string, (a: Fraction, b: Fraction) => Exact>} */
const FRACTIONS = {
  "+": (a, b) => reduced(a.n * b.d + b.n * a.d, a.d * b.d),
  "-": (a, b) => reduced(a.n * b.d - b.n * a.d, a.d * b.d),
  "*": (a, b) => reduced(a.n * b.n, a.d * b.d),
  "/": (a, b) => reduced(a.n * b.d, a.d * b.n),
  "//": (a, b) => floorDivided(a.n * b.d, a.d * b.n),
  "%": (a, b) => reduced(a.n * b.d - floorDivided(a.n * b.d, a.d * b.n) * b.n * a.d, a.d * b.d),
};

/** a + b, a - b, a * b, a / b, a // b or a % b; b is not 0 where it divides.
 *  @param {string} operation @param {Exact} a @param {Exact} b @returns {Exact} */
export function arithmetic(operation, a, b) {
  const floats = typeof a === "number" || typeof b === "number";
  return floats ? FLOATS[operation](float(a), float(b)) : FRACTIONS[operation](ratio(a), ratio(b));
}

/** A number to the power of a whole one; neither 0 to a negative one, nor too large.
 *  @param {Exact} base @param {bigint} exponent @returns {Exact} */
export function power(base, exponent) {
  if (typeof base === "number") return base ** Number(exponent);
  const { n, d } = ratio(base);
  return exponent < 0n ? reduced(d ** -exponent, n ** -exponent) : reduced(n ** exponent, d ** exponent);
}

/** Below 0 where a < b, 0 where they are equal, above 0 else: exactly, whatever kinds they are.
 *  @param {Exact} a @param {Exact} b */
export function compared(a, b) {
  if (typeof a === "number" && typeof b === "number") return a - b;
  const [one, other] = [ratio(a), ratio(b)];
  return Number(one.n * other.d - other.n * one.d);
}

/** @param {Exact} value @returns {bigint} the largest whole number that is not above it */
export function floor(value) {
  if (typeof value === "number") return BigInt(Math.floor(value));
  const { n, d } = ratio(value);
  return floorDivided(n, d);
}

/** A number in six digits, as C's %g writes it: Python's messages have it.
 *  @param {number} value */
export function general(value) {
  if (Object.is(value, -0)) return "-0";
  let [digits, exponent] = value.toExponential(5).split("e");
  const exact = value.toPrecision(21).replace(/e.*|[-.]/g, "").replace(/^0+/, "");
  if (/^\d{5}[02468]50*$/.test(exact)) {
    // Halfway between two: to the even digit, where JavaScript takes the larger one.
    digits = String(Math.sign(value) * Number(`${exact.slice(0, 6)}e-5`));
  }
  const place = Number(exponent);
  if (place >= -4 && place < 6) return String(Number(`${digits}e${place}`));
  return `${Number(digits)}e${place < 0 ? "-" : "+"}${String(Math.abs(place)).padStart(2, "0")}`;
}
