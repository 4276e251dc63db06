// desktop_glsl.js -- what desktop GLSL allows and GLSL ES does not, but for types: see conversions.js.
//
// Other tools' shaders are written for desktops. Here each line stays where it is: blocks of varyings become
// varyings, lines (sampler1D) rows of pictures, functions named as built-in ones get names of their own, and
// global variables get what is worked out from others when the shader begins.

import { closing, edited, macrosOf, tokensOf } from "./glsl_tokens.js";

/** @typedef {import("./glsl_tokens.js").Token} Token */
/** @typedef {import("./glsl_tokens.js").Edit} Edit */

const LINES = "vec4 k_line(sampler2D k_s, float k_p) { return texture(k_s, vec2(k_p, 0.5)); } "
  + "vec4 k_line(sampler2D k_s, float k_p, float k_b) { return texture(k_s, vec2(k_p, 0.5), k_b); } "
  + "vec4 k_lineLod(sampler2D k_s, float k_p, float k_l) { return textureLod(k_s, vec2(k_p, 0.5), k_l); } "
  + "vec4 k_lineFetch(sampler2D k_s, int k_p, int k_l) { return texelFetch(k_s, ivec2(k_p, 0), k_l); } "
  + "int k_lineSize(sampler2D k_s, int k_l) { return textureSize(k_s, k_l).x; } ";
/** @type {Object<string, string>} */
const LINE_FUNCTIONS = {
  texture: "k_line", textureLod: "k_lineLod", texelFetch: "k_lineFetch", textureSize: "k_lineSize",
};
const BUILT_IN = new Set(("radians degrees sin cos tan asin acos atan sinh cosh tanh asinh acosh atanh pow "
  + "exp log exp2 log2 sqrt inversesqrt abs sign floor trunc round roundEven ceil fract mod modf min max "
  + "clamp mix step smoothstep isnan isinf length distance dot cross normalize faceforward reflect refract "
  + "matrixCompMult outerProduct transpose determinant inverse lessThan lessThanEqual greaterThan "
  + "greaterThanEqual equal notEqual any all not dFdx dFdy fwidth "
  + "floatBitsToInt floatBitsToUint intBitsToFloat uintBitsToFloat").split(" "));
const TYPE = /^(?:float|int|uint|bool|[iub]?vec[234]|mat[234](?:x[234])?)$/;
const STORAGE = new Set("uniform in out inout const attribute varying layout precision".split(" "));

/** A stage's text, as desktop GLSL has it, without what GLSL ES has not; its lines stay.
 *  @param {string} text @returns {string} */
export function withoutDesktopForms(text) {
  return [blocks, lines, ownNames, globals, constants].reduce((found, change) => change(found), text);
}

/** Blocks of varyings as varyings: "in V { vec2 uv; } v;" as "in vec2 V_uv;", "v.uv" as "V_uv".
 *  @param {string} text */
function blocks(text) {
  const tokens = tokensOf(text);
  /** @type {Edit[]} */
  const edits = [];
  /** @type {Map<string, string>} */
  const members = new Map();
  for (let at = 0; at + 2 < tokens.length; at++) {
    const [word, { text: name }, brace] = tokens.slice(at, at + 3);
    if (!/^(?:in|out)$/.test(word.text) || brace.text !== "{" || tokens[at - 1]?.text === "(") continue;
    const end = closing(tokens, at + 2), instance = tokens[end + 1].text === ";" ? "" : tokens[end + 1].text;
    let last = end + 1;
    while (tokens[last].text !== ";") last++;
    edits.push({ at: word.at, end: brace.end, text: "" });
    edits.push({ at: tokens[end].at, end: tokens[last].end, text: "" });
    let begins = true;
    for (let inside = at + 3; inside < end; inside++) {
      const token = tokens[inside], next = tokens[inside + 1].text;
      if (begins) edits.push({ at: token.at, end: token.at, text: `${word.text} ` });
      begins = token.text === ";";
      if (![";", ",", "["].includes(next) || !/^[A-Za-z_]/.test(token.text)) continue;
      edits.push({ at: token.at, end: token.end, text: `${name}_${token.text}` });
      members.set(instance ? `${instance}.${token.text}` : token.text, `${name}_${token.text}`);
    }
    at = last;
  }
  const found = edited(text, edits);
  if (!members.size) return found;
  const uses = tokensOf(found);
  return edited(found, uses.flatMap((token, at) => {
    const field = uses[at + 1]?.text === "." ? uses[at + 2]?.text : undefined;
    const dotted = field ? members.get(`${token.text}.${field}`) : undefined;
    if (dotted) return [{ at: token.at, end: uses[at + 2].end, text: dotted }];
    const alone = uses[at - 1]?.text === "." ? undefined : members.get(token.text);
    return alone ? [{ at: token.at, end: token.end, text: alone }] : [];
  }));
}

/** Textures of one dimension as rows of such of two.
 *  @param {string} text */
function lines(text) {
  const tokens = tokensOf(text);
  if (!tokens.some((token) => token.text === "sampler1D")) return text;
  const named = tokens.filter((_, at) => tokens[at - 1]?.text === "sampler1D");
  const names = new Set(named.map((token) => token.text));
  /** @type {Edit[]} */
  const edits = tokens.flatMap((token, at) => {
    if (token.text === "sampler1D") return [{ at: token.at, end: token.end, text: "sampler2D" }];
    const instead = LINE_FUNCTIONS[token.text], of = tokens[at + 2]?.text;
    return instead && names.has(of) ? [{ at: token.at, end: token.end, text: instead }] : [];
  });
  edits.unshift({ at: tokens[0].at, end: tokens[0].at, text: LINES });
  return edited(text, edits);
}

/** Functions that are named as built-in ones get names of their own.
 *  @param {string} text */
function ownNames(text) {
  const tokens = tokensOf(text), own = new Set();
  let depth = 0;
  tokens.forEach(({ text: word }, at) => {
    depth += word === "{" ? 1 : word === "}" ? -1 : 0;
    const defined = depth === 0 && BUILT_IN.has(word) && tokens[at + 1]?.text === "(";
    if (defined && TYPE.test(tokens[at - 1]?.text ?? "")) own.add(word);
  });
  if (!own.size) return text;
  const edits = tokens.filter((token) => own.has(token.text));
  return edited(text, edits.map((token) => ({ at: token.at, end: token.end, text: `k_own_${token.text}` })));
}

/** The words of an expression that are neither types, macros, functions that are built in, nor constants.
 *  @param {Token[]} tokens @param {Set<string>} constant */
const variables = (tokens, constant) => tokens.filter(({ text }, at) => /^[A-Za-z_]/.test(text)
  && !TYPE.test(text) && !BUILT_IN.has(text) && !constant.has(text) && !/^(?:true|false)$/.test(text)
  && tokens[at - 1]?.text !== ".");

/** The index of the sign that ends an initialiser: a comma or a semicolon in no bracket.
 *  @param {Token[]} tokens @param {number} from */
function endOf(tokens, from) {
  let at = from;
  for (; at < tokens.length && ![",", ";"].includes(tokens[at].text); at++) {
    if ("([{".includes(tokens[at].text)) at = closing(tokens, at);
  }
  return at;
}

/** Global variables that are worked out from others get their values where the shader begins.
 *  @param {string} text */
function globals(text) {
  const tokens = tokensOf(text), constant = new Set(macrosOf(text).keys());
  /** @type {Edit[]} */
  const edits = [];
  let depth = 0, begins = "", set = "";
  tokens.forEach(({ text: word }, at) => {
    if (depth === 0 && (at === 0 || [";", "}"].includes(tokens[at - 1].text))) begins = word;
    depth += "({[".includes(word) ? 1 : ")}]".includes(word) ? -1 : 0;
    if (depth || word !== "=") return;
    const end = endOf(tokens, at + 1);
    let name = at - 1;
    while (tokens[name].text === "]") while (tokens[name--].text !== "[");
    if (begins === "const") constant.add(tokens[name].text);
    if (STORAGE.has(begins) || !variables(tokens.slice(at + 1, end), constant).length) return;
    const value = text.slice(tokens[at].at, tokens[end].at);
    set += ` ${tokens[name].text} ${value.replace(/\s*\n\s*/g, " ")};`;
    edits.push({ at: tokens[at].at, end: tokens[end].at, text: value.replace(/[^\n]/g, "") });
  });
  const begin = edits.length;
  tokens.forEach((token, at) => {
    if (token.text !== "main" || tokens[at - 1]?.text !== "void") return;
    const brace = closing(tokens, at + 1) + 1;
    if (tokens[brace]?.text === "{") edits.push({ at: tokens[brace].end, end: tokens[brace].end, text: set });
  });
  return set && edits.length > begin ? edited(text, edits) : text;
}

/** Local constants that are worked out from variables are variables.
 *  @param {string} text */
function constants(text) {
  const tokens = tokensOf(text), constant = new Set(macrosOf(text).keys());
  /** @type {Edit[]} */
  const edits = [];
  let depth = 0;
  tokens.forEach(({ text: word, at: from, end: to }, at) => {
    depth += word === "{" ? 1 : word === "}" ? -1 : 0;
    if (word !== "const" || !TYPE.test(tokens[at + 1]?.text ?? "")) return;
    if (["(", ","].includes(tokens[at - 1]?.text)) return; // a function's parameter
    const end = tokens.findIndex((token, index) => index > at && token.text === ";");
    const name = tokens[at + 2].text;
    const equals = tokens.findIndex((token, index) => index > at && token.text === "=");
    const inside = variables(tokens.slice(equals + 1, end), constant);
    if (depth && inside.length) edits.push({ at: from, end: to, text: "" });
    else constant.add(name);
  });
  return edited(text, edits);
}
