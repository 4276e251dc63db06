// kernel_texts.js -- what a kernel's text says: names it reads, what it is known by, the texts of its stages.

import { declaredUniforms, flatten } from "./source.js";
import { hash, usedBy } from "./staleness.js";

/** @import { Kernel, Shared, Stage } from "./schema.js"
 *  @import { Flat } from "./source.js" */

// ── Desktop GLSL 3.30 as GLSL ES 3.00, line for line: what is on a line stays on it.
//
// ES wants its version on the first line and precisions before anything that has one; it knows neither
// initialisers of uniforms (source.js reads them) nor the extensions of desktop OpenGL.

const VERSION = /^[ \t]*#[ \t]*version\b.*$/m;
const EXTENSION = /^[ \t]*#[ \t]*extension[ \t]+(\w+).*$/gm;
const BLANK = /^[ \t]*(\/\/.*)?$/;
const DIRECTIVE = /^[ \t]*#[ \t]*(\w*)/;
const SAMPLER = /\b[iu]?sampler(?:3D|Cube|2D(?:Array)?)(?:Shadow)?\b/g;
// Comments and directives are passed over, a declaration is looked at.
const DECLARATION = /\/\/.*|\/\*[^]*?\*\/|^[ \t]*#.*|\buniform\b[^;{=]*=/gm;

/** A stage's text in desktop GLSL 1.30 to 3.30 as GLSL ES 3.00, with as many lines.
 *
 *  Of the extensions that it asks for, those named in `extensions` stay; `declarations`, on one line, come
 *  before its own.
 *  @param {string} text @param {{extensions?: string[], declarations?: string}} [options]
 *  @returns {string} */
export function toES(text, { extensions = [], declarations = "" } = {}) {
  const other = text.replace(VERSION, "").replace(EXTENSION, (line, name) =>
    (extensions.includes(name) ? line : ""));
  // Desktops take no notice of precisions; a browser may, and draw another picture.
  const exact = (/** @type {string} */ word) => "highp".padEnd(word.length);
  const found = withoutInitialisers(other).replace(/\b(?:lowp|mediump)\b/g, exact);
  const lines = found.split("\n");
  if (!BLANK.test(lines[0])) throw new Error("the first line of a stage's text is its version, or blank");
  lines[0] = "#version 300 es";
  declare(lines, [...precisions(found), declarations].join(" ").trim());
  return lines.join("\n");
}

/** The statements that give everything in a text its full precision.
 *  @param {string} text */
function precisions(text) {
  const types = ["float", "int", ...new Set(text.match(SAMPLER))];
  return types.map((type) => `precision highp ${type};`);
}

/** Puts a declaration before the first line of code, or where that is in a branch, in each and after them.
 *  @param {string[]} lines @param {string} declaration */
function declare(lines, declaration) {
  let depth = 0, wanted = true;
  for (let index = 1; index < lines.length; index++) {
    const directive = DIRECTIVE.exec(lines[index])?.[1];
    if (directive === undefined) {
      if (wanted) lines[index] = declaration + (lines[index] && ` ${lines[index]}`);
      if (depth === 0) return;
      wanted = false;
    } else {
      if (/^if/.test(directive)) depth++;
      if (directive === "endif") depth--;
      if (/^(?:else|elif|endif)$/.test(directive)) wanted = true;
    }
  }
}

/** A text whose uniforms have no initialisers; line ends inside them stay.
 *  @param {string} text */
function withoutInitialisers(text) {
  let found = "", from = 0;
  DECLARATION.lastIndex = 0;
  for (let match = DECLARATION.exec(text); match; match = DECLARATION.exec(text)) {
    if (!match[0].startsWith("uniform")) continue;
    found += text.slice(from, DECLARATION.lastIndex - 1);
    from = DECLARATION.lastIndex - 1;
    let depth = 0, inside = false;
    for (; from < text.length && (depth || text[from] !== ";"); from++) {
      if ("([{".includes(text[from])) depth++;
      if (")]}".includes(text[from])) depth--;
      if (!depth && text[from] === "=") inside = true;
      if (!depth && text[from] === ",") inside = false;
      if (!inside || text[from] === "\n") found += text[from];
    }
    DECLARATION.lastIndex = from;
  }
  return found + text.slice(from);
}

// ── Makes the text of a shader stage from a kernel's flat text: shader/stage_recipe.py.

const VERSION_LINE = /^\s*#\s*version\b/;

/** The text of a stage, in desktop GLSL, and the line of it, from 1, of the first of the kernel's lines;
 *  0: it is made of none.
 *  @param {Stage} stage @param {Flat} flat @returns {{text: string, first: number}} */
export function stageText(stage, flat) {
  if (stage.text !== undefined) return { text: stage.text, first: 0 };
  const before = (stage.before ?? [])
    .filter(({ names }) => !names || names.some((name) => flat.names.has(name)))
    .map(({ text }) => `${text}\n`).join("");
  const after = stage.after ? `${stage.after}\n` : "";
  return { text: before + linesOf(stage, flat) + after, first: before.split("\n").length };
}

/** The kernel's lines as a stage has them.
 *  @param {Stage} stage @param {Flat} flat */
function linesOf(stage, flat) {
  const codes = flat.lines.map(({ code }) => code);
  if (stage.keepsVersion) {
    // Some drivers do not count blank lines above #version.
    const above = Math.max(codes.findIndex((code) => code.trim()), 0);
    return `${codes.fill("//", 0, above).join("\n")}\n`;
  }
  const version = codes.findIndex((code) => VERSION_LINE.test(code));
  if (version >= 0) codes[version] = "";
  let code = `${codes.join("\n")}\n`;
  if (stage.without) code = withoutFunction(code, stage.without);
  for (const [name, instead] of Object.entries(stage.replace ?? {})) {
    code = code.replace(new RegExp(`\\b${name}\\b`, "g"), instead);
  }
  return code;
}

/** Blanks a function's definition, not its line ends: what one stage calls may be missing in the other.
 *  @param {string} code @param {string} name */
function withoutFunction(code, name) {
  const match = new RegExp(`\\b\\w+\\s+${name}\\s*\\([^)]*\\)\\s*\\{`).exec(code);
  if (!match) return code;
  let end = match.index + match[0].length;
  for (let depth = 1; depth && end < code.length; end++) {
    depth += code[end] === "{" ? 1 : code[end] === "}" ? -1 : 0;
  }
  return code.slice(0, match.index) + code.slice(match.index, end).replace(/[^\n]/g, " ") + code.slice(end);
}

// ── Filters textures of 32-bit floats in the shader, where the device does not.
//
// Phones lack OES_texture_float_linear: there such a texture reads as zeros wherever it is to be filtered.
// In a
// program's text each texture(NAME, place) and its like becomes a function that mixes four texels, for
// samplers
// NAME that read such a texture and for the parameters of functions that they are handed to.

/** @typedef {"clamp" | "repeat" | "mirror"} Wrap */

const ROUND = "(k_i % (2 * k_n) + 2 * k_n) % (2 * k_n)";
const MOVED = {
  clamp: "clamp(k_i, ivec2(0), k_n - 1)",
  repeat: "(k_i % k_n + k_n) % k_n",
  mirror: `min(${ROUND}, 2 * k_n - 1 - ${ROUND})`,
};

/** @param {Wrap} wrap */
const functions = (wrap) => {
  const name = `k_linear_${wrap}`, call = `{ return ${name}(k_s, k_p); }`;
  const texel = `vec4 ${name}(sampler2D k_s, ivec2 k_i) { ivec2 k_n = textureSize(k_s, 0);`
    + ` return texelFetch(k_s, ${MOVED[wrap]}, 0); }`;
  const mixed = `vec4 ${name}(sampler2D k_s, vec2 k_p) { vec2 k_q = k_p * vec2(textureSize(k_s, 0)) - 0.5;`
    + " ivec2 k_i = ivec2(floor(k_q)); vec2 k_f = k_q - floor(k_q); return mix("
    + `mix(${name}(k_s, k_i), ${name}(k_s, k_i + ivec2(1, 0)), k_f.x),`
    + ` mix(${name}(k_s, k_i + ivec2(0, 1)), ${name}(k_s, k_i + 1), k_f.x), k_f.y); }`;
  return `${texel} ${mixed} vec4 ${name}(sampler2D k_s, vec2 k_p, float k_l) ${call}`
    + ` vec4 ${name}(sampler2D k_s, vec2 k_p, vec2 k_x, vec2 k_y) ${call} `;
};

/** Return a stage's text in which some samplers are filtered by hand, and the functions that it calls for
 *  that,
 *  on one line; the text keeps its lines.
 *  @param {string} text without comments @param {Map<string, Wrap>} samplers */
const filteredByHand = (text, samplers) => {
  const names = reached(text, samplers), list = [...names.keys()].join("|");
  const calls = new RegExp(`\\btexture(?:Lod|Grad)?\\s*\\(\\s*(${list})\\b(?=\\s*,)`, "g");
  const changed = text.replace(calls, (_, name) => `k_linear_${names.get(name)}(${name}`);
  const wraps = changed === text ? [] : [...new Set(names.values())];
  return { text: changed, functions: wraps.map(functions).join("") };
};

/** Return the samplers and the functions' parameters that they reach.
 *  @param {string} text @param {Map<string, Wrap>} samplers @returns {Map<string, Wrap>} */
const reached = (text, samplers) => {
  const found = new Map(samplers);
  const taking = [...text.matchAll(/\b(\w+)\s*\(([^()]*\bsampler2D\b[^()]*)\)\s*\{/g)].map((match) =>
    ({ name: match[1], parameters: match[2].split(",").map((each) => each.trim().replace(/.*\s/, "")) }));
  for (let before = -1; before !== found.size;) {
    before = found.size;
    for (const { name, parameters } of taking) {
      for (const given of callsOf(text, name)) given.forEach((argument, i) => {
        const wrap = found.get(argument);
        if (wrap && parameters[i] && !found.has(parameters[i])) found.set(parameters[i], wrap);
      });
    }
  }
  return found;
};

/** Return the arguments of each call of a function.
 *  @param {string} text @param {string} name @returns {string[][]} */
const callsOf = (text, name) => [...text.matchAll(new RegExp(`\\b${name}\\s*\\(`, "g"))].map((match) => {
  const found = [""];
  for (let at = match.index + match[0].length, depth = 1; at < text.length; at++) {
    const mark = text[at];
    depth += mark === "(" ? 1 : mark === ")" ? -1 : 0;
    if (!depth) break;
    if (mark === "," && depth === 1) found.push("");
    else found[found.length - 1] += mark;
  }
  return found.map((each) => each.trim());
});

// ── What a kernel's text says

/** @typedef {object} KernelText
 *  @property {Kernel} kernel
 *  @property {import("./source.js").Flat} flat
 *  @property {import("./source.js").Flat} vertex   its author's own vertex shader's, else the same
 *  @property {string[]} given         names that the engine gives it
 *  @property {Set<string>} used       names in its text besides their declaration, or in its header
 *  @property {string} identity        the same for the same header and text
 *  @property {Map<string, import("./programs.js").Program>} programs   by how samplers are filtered
 *  @property {Map<string, Map<string, Wrap>>} hands   those ways
 *  @property {[string, any][]} own    uniforms with a value in the text that its header does not know */

/** Read a kernel; throws where a file is missing, with `file` and `line`.
 *  @param {Shared} shared @param {Kernel} kernel @param {Object<string, string>} texts edited files
 *  @returns {KernelText} */
export const readKernel = (shared, kernel, texts) => {
  const source = kernel.kind === "source";
  const flat = source ? { lines: [], names: new Set() }
    : flatten(shared, kernel.file, texts, { once: !!kernel.dialect });
  const once = { once: !!kernel.dialect }, own = kernel.vertex?.file;
  const vertex = own ? flatten(shared, own, texts, once) : flat;
  const code = (own ? [...flat.lines, ...vertex.lines] : flat.lines).map((line) => line.code).join("\n");
  const given = Object.keys(shared.given).filter((name) => flat.names.has(name));
  const declared = new Set(kernel.parameters.map(({ name }) => name));
  return {
    kernel, flat, vertex, given, programs: new Map(), hands: new Map(),
    used: usedBy(kernel, code, given),
    identity: hash(JSON.stringify([kernel, code])),
    own: declaredUniforms(flat.lines).filter(({ name, value }) => value !== null && !declared.has(name))
      .map(({ name, value }) => [name, value]),
  };
};

/** Return the texts of a kernel's stages in GLSL ES, and the first line of its own in each.
 *  @param {KernelText} read
 *  @param {Map<string, Wrap>} byHand samplers that are filtered in the text
 *  @param {string} atEnd of the fragment shader's main function
 *  @returns {{texts: [string, string], first: [number, number]}} */
export const stagesOf = ({ kernel, flat, vertex }, byHand, atEnd) => {
  const stages = [kernel.vertex, kernel.fragment].map((stage, i) => {
    const { text, first } = stageText(stage, i ? flat : vertex);
    const filtered = byHand.size ? filteredByHand(text, byHand) : { text, functions: "" };
    const found = i && atEnd ? filtered.text.replace(/\}\s*$/, `${atEnd} }\n`) : filtered.text;
    const how = { extensions: kernel.extensions, declarations: filtered.functions };
    return { text: toES(found, how), first };
  });
  return { texts: [stages[0].text, stages[1].text], first: [stages[0].first, stages[1].first] };
};
