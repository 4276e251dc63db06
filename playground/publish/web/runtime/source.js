// source.js -- flattens a GLSL file's includes, so that each line knows its file and line: shader/source.py.
//
// The driver is given `code`: comments, #include, #line and the project's pragmas are blanked, lines stay. A
// backslash at a line's end joins it to the next; the joined line is in the first one's place.

import { withCallsJoined } from "./macro_calls.js";

/** @typedef {import("./schema.js").Shared} Shared */
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
