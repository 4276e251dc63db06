// source.js -- flattens a GLSL file's includes, so that each line knows its file and line: shader/source.py.
//
// The driver is given `code`: comments, #include, #line and the project's pragmas are blanked, lines stay. A
// backslash at a line's end joins it to the next; the joined line is in the first one's place.

/** @import { Shared, Value } from "./schema.js" */

// ── Joins calls of function-like macros that span lines: shader/source.py.

const DEFINE = /^\s*#\s*define\s+(\w+)(\(|\s+(\w+)\s*$)?/;
const DIRECTIVE = /^\s*#/;
const MAX_CALL_LINES = 1000; // that one call may span: an unclosed one must not swallow the file

/** Lines of code, comments blanked and ASCII only, with each macro call on one line; as many lines.
 *  @param {string[]} codes @returns {string[]} */
function withCallsJoined(codes) {
  const found = [...codes];
  /** @type {Set<string>} */
  const macros = new Set();
  let pattern = /$^/g;
  for (let index = 0; index < found.length; index++) {
    const define = DEFINE.exec(found[index]);
    if (define) {
      const [, name, bracket, meaning] = define;
      if (bracket === "(" || macros.has(meaning)) {
        macros.add(name);
        pattern = new RegExp(`\\b(?:${[...macros].join("|")})\\b\\s*(\\(?)`, "g");
      }
    } else if (macros.size && !DIRECTIVE.test(found[index])) {
      join(found, index, pattern);
    }
  }
  return found;
}

/** Appends to a line those that a macro call begun on it goes on to; leaves it where the call never ends.
 *  @param {string[]} codes @param {number} index @param {RegExp} pattern */
function join(codes, index, pattern) {
  let joined = codes[index];
  let taken = joined; // as far as calls are whole
  let end = index;
  for (let last = index + 1, open = openAtEnd(joined, pattern); open !== "no"; last++) {
    if (last >= codes.length || last - index > MAX_CALL_LINES || DIRECTIVE.test(codes[last])) break;
    const code = codes[last].trim();
    if (open === "maybe" && code && !code.startsWith("(")) break;
    if (code) joined += ` ${code}`;
    open = openAtEnd(joined, pattern);
    if (open === "no") [taken, end] = [joined, last];
  }
  codes[index] = taken;
  codes.fill("", index + 1, end + 1);
}

/** Whether a macro's call is open at a line's end; "maybe": the name ends it.
 *  @param {string} code @param {RegExp} pattern @returns {"no" | "yes" | "maybe"} */
function openAtEnd(code, pattern) {
  pattern.lastIndex = 0;
  for (let match = pattern.exec(code); match; match = pattern.exec(code)) {
    const position = pattern.lastIndex;
    if (!match[1]) {
      if (!code.slice(position).trim()) return "maybe";
      continue;
    }
    let depth = 1;
    for (let at = position; at < code.length && depth; at++) {
      depth += code[at] === "(" ? 1 : code[at] === ")" ? -1 : 0;
    }
    if (depth) return "yes";
  }
  return "no";
}

// ── Flattens a GLSL file's includes, so that each line knows its file and line

/** What the driver is given of a line, the file and the line in it, from 1, and the line as written.
 *  @typedef {{code: string, file: string, line: number, raw: string}} Line */
/** @typedef {{lines: Line[], names: Set<string>}} Flat  names: every identifier in the code */

// What Python takes for white space and for a word: \s and \w of JavaScript are others beyond ASCII.
const SPACE = "[\\t-\\r\\x1c- \\x85\\xa0\\u1680\\u2000-\\u200a\\u2028\\u2029\\u202f\\u205f\\u3000]";
const WORD_ENDS = "(?![\\p{L}\\p{N}_])";
const NAME = `"([^"]*)"|<([^>]*)>`;
const INCLUDE = new RegExp(`^${SPACE}*#${SPACE}*include${WORD_ENDS}${SPACE}*(?:${NAME})?(.*)`, "su");
const BLANKED = new RegExp(
  `^${SPACE}*#${SPACE}*(?:line${WORD_ENDS}|pragma${SPACE}+(?:kernel|source|draw|compute)${WORD_ENDS})`, "u");
const IS_SPACE = new RegExp(SPACE);
const NOT_TAB = /[^\t]/gu;
const NOT_ASCII = /[^\t -~]/gu;
const MAX_DEPTH = 32;
const MAX_LINES = 200_000;
const MAX_INCLUDES = 4096;

/** Reads a file and everything that it includes.
 *
 *  `texts` are taken in place of `shared.files`. With `once`, as in another tool's shader, a file that was
 *  included is not included again. Throws an error with `file` and `line` for a missing or cyclic include.
 *  @param {Pick<Shared, "files" | "includes">} shared @param {string} file
 *  @param {Object<string, string>} [texts] @param {{once?: boolean}} [options] @returns {Flat} */
export function flatten(shared, file, texts = {}, { once = false } = {}) {
  /** @type {Line[]} */
  const lines = [];
  const read = new Set([file]);
  let includes = 0;
  /** @param {string} name @returns {string | undefined} */
  const textOf = (name) => [texts, shared.files].find((all) => Object.hasOwn(all, name))?.[name];

  /** @param {string} at @param {string[]} stack */
  const add = (at, stack) => {
    let inBlock = false;
    const physical = normalised(textOf(at) ?? "").split("\n");
    for (let index = 0; index < physical.length;) {
      const [joined, count] = joinedLine(physical, index);
      let code;
      [code, inBlock] = splitComments(joined, inBlock);
      const include = INCLUDE.exec(code);
      const line = index + 1;
      code = include || BLANKED.test(code) ? "" : code.replace(/[\v\f]/g, " ").replace(NOT_ASCII, "?");
      lines.push({ code, file: at, line, raw: physical[index] });
      for (let more = 1; more < count; more++) {
        lines.push({ code: "", file: at, line: line + more, raw: physical[index + more] });
      }
      if (lines.length > MAX_LINES) {
        throw errorAt(at, line, `more than ${MAX_LINES} lines with its includes; `
          + "is something included over and over?");
      }
      if (include) follow(include, at, line, stack);
      index += count;
    }
  };

  /** @param {RegExpExecArray} include @param {string} at @param {number} line @param {string[]} stack */
  const follow = (include, at, line, stack) => {
    const name = include[1] || include[2];
    if (!name || strippedEnd(include[3])) {
      throw errorAt(at, line,
        '#include needs one file name in quotes, as #include "noise/hash.glsl"');
    }
    if (++includes > MAX_INCLUDES) {
      throw errorAt(at, line, `more than ${MAX_INCLUDES} includes; is something included over and over?`);
    }
    const target = placesOf(shared, at, name).find((place) => textOf(place) !== undefined);
    if (target === undefined) throw errorAt(at, line, `no file '${name}' to include`);
    if (once && read.has(target)) return;
    if (stack.includes(target)) {
      const cycle = [...stack.slice(stack.indexOf(target)), target];
      throw errorAt(at, line, `include cycle: ${cycle.join(" → ")}`);
    }
    if (stack.length >= MAX_DEPTH) throw errorAt(at, line, `includes nested more than ${MAX_DEPTH} deep`);
    read.add(target);
    add(target, [...stack, target]);
  };

  add(file, [file]);
  withCallsJoined(lines.map(({ code }) => code)).forEach((code, index) => { lines[index].code = code; });
  const names = new Set(lines.flatMap(({ code }) => code.match(/[A-Za-z_]\w*/g) ?? []));
  return { lines, names };
}

/** An error with its place.
 *  @param {string} file @param {number} line @param {string} message */
function errorAt(file, line, message) {
  return Object.assign(new Error(message), { file, line });
}

/** The files that an include may mean: the exported one, or one as Python looks for it (an edit may name
 *  another file): in the includer's folder, in the sketch's own, which begins with "./", in the library.
 *  @param {Pick<Shared, "includes">} shared @param {string} includer @param {string} name
 *  @returns {string[]} */
function placesOf(shared, includer, name) {
  const known = shared.includes[includer];
  if (known && Object.hasOwn(known, name)) return [known[name]];
  const folder = includer.slice(0, includer.lastIndexOf("/") + 1);
  const own = includer.startsWith("./");
  return [folder + name, ...(own ? [`./${name}`] : []), name].map(plainPath);
}

/** A path without "." and ".." in it, but for "./" at its beginning.
 *  @param {string} path */
function plainPath(path) {
  /** @type {string[]} */
  const parts = [];
  for (const part of path.split("/")) {
    if (part === ".." && parts.length && parts[parts.length - 1] !== "..") parts.pop();
    else if (part !== "." && part !== "") parts.push(part);
  }
  return (path.startsWith("./") ? "./" : "") + parts.join("/");
}

/** A text whose lines end in LF, without a byte order mark.
 *  @param {string} text */
function normalised(text) {
  return text.replace(/^\ufeff/, "").replace(/\r\n?/g, "\n");
}

/** A line with those that its backslashes join to it, and how many lines that are.
 *  @param {string[]} lines @param {number} index @returns {[string, number]} */
function joinedLine(lines, index) {
  let last = index;
  while (lines[last].endsWith("\\") && last + 1 < lines.length) last++;
  const taken = lines.slice(index, last).map((line) => line.slice(0, -1));
  return [taken.join("") + lines[last], last - index + 1];
}

/** The code with its comments blanked, and whether a block comment goes on.
 *  @param {string} raw @param {boolean} inBlock @returns {[string, boolean]} */
function splitComments(raw, inBlock) {
  let code = "";
  let position = 0;
  const mark = /"(?:[^"\\]|\\.)*(?:"|$)|\/\/|\/\*/gs;
  for (;;) {
    if (inBlock) {
      const close = raw.indexOf("*/", position);
      const end = close < 0 ? raw.length : close + 2;
      code += raw.slice(position, end).replace(NOT_TAB, " ");
      if (close < 0) return [strippedEnd(code), true];
      position = end;
      inBlock = false;
    }
    mark.lastIndex = position;
    let match = mark.exec(raw);
    while (match && match[0].startsWith('"')) match = mark.exec(raw);
    if (!match) return [strippedEnd(code + raw.slice(position)), false];
    code += raw.slice(position, match.index);
    if (match[0] === "//") return [strippedEnd(code), false];
    code += "  ";
    position = match.index + 2;
    inBlock = true;
  }
}

/** A text without the white space at its end.
 *  @param {string} text */
function strippedEnd(text) {
  let end = text.length;
  while (end && IS_SPACE.test(text[end - 1])) end--;
  return text.slice(0, end);
}

// ── Reads the uniforms of a flat text, with initial values: shader/declarations.py.

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
