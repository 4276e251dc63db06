// glsl_types.js -- types of GLSL, as far as conversions need them: what operators and functions give.

/** "float", "vec3", "ivec2", "mat4", a structure's name; an array as "float[]"; "": not known.
 *  @typedef {string} Type */

const VECTOR = /^(?:(float|int|uint|bool)|([iub]?)vec([234]))$/;
const BASES = /** @type {Object<string, string>} */ ({ "": "float", i: "int", u: "uint", b: "bool" });
const PREFIXES = /** @type {Object<string, string>} */ ({ float: "", int: "i", uint: "u", bool: "b" });

/** What a scalar's or a vector's numbers are; "float" of a matrix, "" of all else.
 *  @param {Type} type */
export function baseOf(type) {
  const match = VECTOR.exec(type);
  if (match) return match[1] ?? BASES[match[2]];
  return /^mat[234]/.test(type) && !type.endsWith("]") ? "float" : "";
}

/** How many numbers a scalar or a vector has, 0 of all else.
 *  @param {Type} type */
export function sizeOf(type) {
  const match = VECTOR.exec(type);
  return match ? Number(match[3] ?? 1) : 0;
}

/** @param {string} base @param {number} size @returns {Type} */
export const typeOf = (base, size) => (size === 1 ? base : size ? `${PREFIXES[base]}vec${size}` : "");

/** Rows of a matrix's columns: the size of what it gives of a vector.
 *  @param {Type} type */
const rowsOf = (type) => Number(/^mat(\d)(?:x(\d))?$/.exec(type)?.slice(1).filter(Boolean).pop() ?? 0);

/** Whether a value becomes another by itself on a desktop: whole numbers floats, or unsigned.
 *  @param {string} from @param {string} to base types */
export const isWidened = (from, to) =>
  (to === "float" && (from === "int" || from === "uint")) || (to === "uint" && from === "int");

/** What an operator gives.
 *  @param {string} sign @param {Type} left @param {Type} right @returns {Type} */
export function given(sign, left, right) {
  if (["<", ">", "<=", ">=", "==", "!=", "&&", "||", "^^"].includes(sign)) return "bool";
  if (/^mat/.test(left) || /^mat/.test(right)) {
    if (sign !== "*" || !left || !right) return /^mat/.test(left) ? left : right;
    if (/^mat/.test(left) && sizeOf(right) > 1) return typeOf("float", rowsOf(left));
    if (/^mat/.test(right) && sizeOf(left) > 1) return typeOf("float", Number(right[3]));
    return /^mat/.test(left) ? left : right;
  }
  const bases = [baseOf(left), baseOf(right)], size = Math.max(sizeOf(left), sizeOf(right));
  if (!bases[0] || !bases[1]) return "";
  return typeOf(["<<", ">>"].includes(sign) || !isWidened(...pair(bases)) ? bases[0] : bases[1], size);
}

/** @param {string[]} two @returns {[string, string]} */
const pair = (two) => [two[0], two[1]];

const FLOATS = new Set(("radians degrees sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh pow exp "
  + "log exp2 log2 sqrt inversesqrt floor trunc round roundEven ceil fract mod mix step smoothstep length "
  + "distance dot cross normalize faceforward reflect refract dFdx dFdy fwidth fma").split(" "));
const ANY = new Set(["abs", "sign", "min", "max", "clamp"]);
const WITH_FLOATS = /^texture(?:Proj|Lod|Grad|ProjLod|Offset|LodOffset)?$/;
const COMPARING = new Set(
  "lessThan lessThanEqual greaterThan greaterThanEqual equal notEqual not".split(" "));
/** @type {Object<string, Type>} */
const ALWAYS = {
  length: "float", distance: "float", dot: "float", determinant: "float", cross: "vec3", any: "bool",
  all: "bool", texelFetch: "vec4", texelFetchOffset: "vec4",
};

/** Whether a built-in function takes floats, so that its whole numbers become some.
 *  @param {string} name @param {Type[]} types of its arguments */
export function takesFloats(name, types) {
  if (FLOATS.has(name) || WITH_FLOATS.test(name)) return true;
  return ANY.has(name) && types.some((type) => baseOf(type) === "float");
}

/** What a built-in function gives; "" of one that is not known.
 *  @param {string} name @param {Type[]} types of its arguments @returns {Type} */
export function givenBy(name, types) {
  if (WITH_FLOATS.test(name)) return "vec4";
  if (Object.hasOwn(ALWAYS, name)) return ALWAYS[name];
  const size = Math.max(...types.map(sizeOf), 0);
  if (COMPARING.has(name)) return typeOf("bool", size);
  if (name === "textureSize") return "";
  if (name === "transpose" || name === "inverse") return types[0] ?? "";
  if (name === "isnan" || name === "isinf") return typeOf("bool", size);
  const bits = /^(?:floatBitsTo(Int|Uint)|u?intBitsTo(Float))$/.exec(name);
  if (bits) return typeOf((bits[1] ?? bits[2]).toLowerCase(), size);
  if (FLOATS.has(name)) return types.every((type) => type) ? typeOf("float", size) : "";
  if (!ANY.has(name) || !types.every((type) => type)) return "";
  return typeOf(takesFloats(name, types) ? "float" : baseOf(types[0]), size);
}

/** What a field of a vector is: "v.xy" of a "vec3" a "vec2".
 *  @param {Type} type @param {string} field @returns {Type} */
export const swizzled = (type, field) => (sizeOf(type) ? typeOf(baseOf(type), field.length) : "");

/** What an element of an array, a vector or a matrix is.
 *  @param {Type} type @returns {Type} */
export function elementOf(type) {
  if (type.endsWith("[]")) return type.slice(0, -2);
  return /^mat/.test(type) ? typeOf("float", rowsOf(type)) : sizeOf(type) > 1 ? baseOf(type) : "";
}
