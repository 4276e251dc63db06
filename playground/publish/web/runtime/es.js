// es.js -- desktop GLSL 3.30 as GLSL ES 3.00, line for line: what is on a line stays on it.
//
// ES wants its version on the first line and precisions before anything that has one; it knows neither
// initialisers of uniforms (uniforms.js reads them) nor the extensions of desktop OpenGL.

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
