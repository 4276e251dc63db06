// uniforms.js -- reads the uniforms of a flat text, with initial values: shader/declarations.py.

/** @typedef {import("./schema.js").Value} Value */
/** @typedef {import("./source.js").Line} Line */

/** A uniform with what it has where nothing sets it; of a sampler, and of an array, null.
 *  @typedef {{name: string, type: string, value: Value | null, file: string, line: number}} Declared */

const UNIFORM = new RegExp(
  "^\\s*(?:layout\\s*\\([^)]*\\)\\s*)?uniform\\s+(?:(?:lowp|mediump|highp)\\s+)?"
  + "(\\w+)\\s+(\\w+)\\s*(\\[[^\\]]*\\])?\\s*(?:=([^;]*))?;");
const FLOAT = /^[-+]?(?:\d+\.\d*|\.\d+|\d+(?=[eEfF]))(?:[eE][-+]?\d+)?[fF]?$/;
const WHOLE = /^([-+]?)(?:0[xX]([0-9a-fA-F]+)|(\d+))[uU]?$/;
const VECTOR = /^[iub]?vec([234])$/;
const SCALARS = ["float", "int", "uint", "bool"];

/** The uniforms of a text, in the order of their lines; one that is there twice is taken once.
 *
 *  Throws an error with `file` and `line` for an initial value that is no literal.
 *  @param {Line[]} lines @returns {Declared[]} */
export function declaredUniforms(lines) {
  /** @type {Map<string, Declared>} */
  const found = new Map();
  for (const { code, file, line } of lines) {
    const match = UNIFORM.exec(code);
    if (!match || found.has(match[2])) continue;
    const [, type, name, array, initial] = match;
    const value = array ? null : initialValue(type, initial);
    if (value === undefined) {
      const message = `the initialiser of '${name}' must be a literal, found ${initial.trim()}`;
      throw Object.assign(new Error(message), { file, line });
    }
    found.set(name, { name, type, value, file, line });
  }
  return [...found.values()];
}

/** What an initialiser gives a uniform; undefined: it is no literal of that type.
 *  @param {string} type @param {string | undefined} initial @returns {Value | null | undefined} */
function initialValue(type, initial) {
  const length = Number(VECTOR.exec(type)?.[1] ?? (SCALARS.includes(type) ? 1 : 0));
  if (!length) return null;
  const boolean = type.startsWith("b");
  if (initial === undefined) {
    const zero = boolean ? false : 0;
    return length === 1 ? zero : new Array(length).fill(Number(zero));
  }
  let parts = [initial.trim()];
  if (length > 1) {
    const inner = new RegExp(`^${type}\\s*\\((.*)\\)$`, "s").exec(parts[0]);
    if (!inner) return undefined;
    parts = inner[1].split(",").map((part) => part.trim());
    if (parts.length === 1) parts = new Array(length).fill(parts[0]);
  }
  const whole = /^[iu]/.test(type);
  const numbers = parts.map((part) => (boolean ? boolOf(part) : numberOf(part, length > 1 || !whole)));
  if (parts.length !== length || numbers.includes(undefined)) return undefined;
  const values = /** @type {number[]} */ (numbers).map((number) => (whole ? Math.trunc(number) : number));
  return length > 1 ? values : boolean ? Boolean(values[0]) : values[0];
}

/** @param {string} text */
function boolOf(text) {
  return { true: 1, false: 0 }[text];
}

/** A number as GLSL writes it: 0x1F and 017 have the bases 16 and 8.
 *  @param {string} text @param {boolean} fractions  whether a real number will do */
function numberOf(text, fractions) {
  const whole = WHOLE.exec(text);
  if (whole) {
    const [, sign, sixteen, digits] = whole;
    if (digits?.startsWith("0") && /[89]/.test(digits)) return undefined;
    const size = sixteen ? parseInt(sixteen, 16) : parseInt(digits, digits.startsWith("0") ? 8 : 10);
    return sign === "-" && size ? -size : size;
  }
  if (!fractions || !FLOAT.test(text)) return undefined;
  const number = Number(text.replace(/[fF]$/, ""));
  return Number.isFinite(number) ? number : undefined;
}
