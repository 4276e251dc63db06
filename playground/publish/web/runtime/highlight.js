// highlight.js -- the colours of a GLSL text: its tokens, line by line.

/** What a token is; "annotation" is a comment that Python reads ("//!"), "pragma" one of the project's own.
 *  @typedef {"" | "comment" | "annotation" | "directive" | "pragma" | "keyword" | "type" | "builtin"
 *            | "number"} TokenKind */

/** What a line begins in: "" code, "comment" a long comment, "directive" or "pragma" one that a backslash
 *  carries on.
 *  "quote" the text in quotes of such a pragma, where "//" is a division.
 *  @typedef {"" | "comment" | "directive" | "pragma" | "quote"} LineState */

/** @typedef {{parts: [TokenKind, string][], next: LineState}} HighlightedLine */

const KEYWORDS = new Set((
  "attribute const uniform varying buffer shared in out inout layout flat smooth noperspective centroid " +
  "sample patch lowp mediump highp precision invariant precise coherent volatile restrict readonly " +
  "writeonly break continue do for while switch case default if else subroutine discard return struct " +
  "true false common partition active asm class union enum typedef template this resource goto inline " +
  "noinline public static extern external interface long short half fixed unsigned superp input output " +
  "filter sizeof cast namespace using").split(" "));
const TYPE = new RegExp("^(?:void|bool|u?int|float|double|atomic_uint|[biudhf]?vec[234]|" +
  "d?mat[234](?:x[234])?|sampler3DRect|" +
  "[iu]?(?:sampler|image)(?:[123]D|Cube|2DRect|Buffer|2DMS)(?:Array)?(?:Shadow)?)$");
const BUILTIN = new RegExp("^(?:gl_\\w*|radians|degrees|a?sinh?|a?cosh?|a?tanh?|pow|exp2?|log2?|sqrt|" +
  "inversesqrt|abs|sign|floor|trunc|round|roundEven|ceil|fract|modf?|min|max|clamp|mix|step|smoothstep|" +
  "isnan|isinf|floatBitsToU?[iI]nt|u?intBitsToFloat|length|distance|dot|cross|normalize|faceforward|" +
  "reflect|refract|outerProduct|transpose|determinant|inverse|matrixCompMult|lessThan(?:Equal)?|" +
  "greaterThan(?:Equal)?|equal|notEqual|any|all|not|texture(?:Size|Proj|Lod|Offset|Grad)?|" +
  "texelFetch(?:Offset)?|dFd[xy]|fwidth|(?:un)?pack\\w+|main)$");

const TOKEN = new RegExp(
  "(?<comment>//.*|/\\*)" +
  "|(?<number>0[xX][0-9a-fA-F]*[uU]?|(?:\\d+\\.?\\d*|\\.\\d+)(?:[eE][-+]?\\d+)?(?:[uUfF]|lf|LF)?)" +
  "|(?<word>[A-Za-z_]\\w*)" +
  "|(?<rest>[^A-Za-z_0-9/.]+|.)", "y");
const DIRECTIVE = /^\s*#/;
const OWN_PRAGMA = /^\s*#\s*pragma\s+(?:kernel|source|draw|compute)\b/;

/** Split one line into tokens.
 *  @param {string} line
 *  @param {LineState} state  what it begins in
 *  @returns {HighlightedLine} */
export function highlightLine(line, state) {
  /** @type {[TokenKind, string][]} */
  const parts = [];
  let at = 0;
  /** @type {LineState} */
  let kind = state;
  if (kind === "comment") {
    const end = line.indexOf("*/");
    if (end < 0) return { parts: line ? [["comment", line]] : [], next: "comment" };
    parts.push(["comment", line.slice(0, end + 2)]);
    at = end + 2;
    kind = "";
  } else if (kind === "" && DIRECTIVE.test(line)) kind = OWN_PRAGMA.test(line) ? "pragma" : "directive";
  if (kind === "") return code(line, at, parts);
  return directive(line, kind, parts);
}

/** Highlight lines one after the other, from the first.
 *  @param {string[]} lines
 *  @returns {HighlightedLine[]} */
export function highlight(lines) {
  /** @type {LineState} */
  let state = "";
  return lines.map((line) => {
    const found = highlightLine(line, state);
    state = found.next;
    return found;
  });
}

/** @param {string} line @param {number} at @param {[TokenKind, string][]} parts @returns {HighlightedLine} */
function code(line, at, parts) {
  TOKEN.lastIndex = at;
  for (let match = TOKEN.exec(line); match; match = TOKEN.exec(line)) {
    const { comment, number, word } = /** @type {Object<string, string | undefined>} */ (match.groups);
    if (comment === "/*") {
      const end = line.indexOf("*/", match.index + 2);
      parts.push(["comment", line.slice(match.index, end < 0 ? undefined : end + 2)]);
      if (end < 0) return { parts, next: "comment" };
      TOKEN.lastIndex = end + 2;
    } else if (comment) {
      parts.push([comment.startsWith("//!") ? "annotation" : "comment", comment]);
    } else parts.push([number ? "number" : word ? kindOf(word) : "", match[0]]);
  }
  return { parts: joined(parts), next: "" };
}

/** @param {string} line @param {"directive" | "pragma" | "quote"} kind @param {[TokenKind, string][]} parts
 *  @returns {HighlightedLine} */
function directive(line, kind, parts) {
  const shown = kind === "directive" ? kind : "pragma";
  let quoted = kind === "quote", end = line.length;
  for (let at = 0; at < line.length; at++) {
    if (line[at] === '"') quoted = !quoted;
    else if (!quoted && line[at] === "/" && (line[at + 1] === "/" || line[at + 1] === "*")) {
      end = at;
      break;
    }
  }
  if (end) parts.push([shown, line.slice(0, end)]);
  if (end < line.length) return code(line, end, parts);
  if (!line.endsWith("\\")) return { parts, next: "" };
  return { parts, next: quoted && shown === "pragma" ? "quote" : shown };
}

/** @param {string} word @returns {TokenKind} */
function kindOf(word) {
  return KEYWORDS.has(word) ? "keyword" : TYPE.test(word) ? "type" : BUILTIN.test(word) ? "builtin" : "";
}

/** Neighbours of one kind become one: fewer elements to draw.
 *  @param {[TokenKind, string][]} parts @returns {[TokenKind, string][]} */
function joined(parts) {
  /** @type {[TokenKind, string][]} */
  const found = [];
  for (const [kind, text] of parts) {
    const last = found.at(-1);
    if (last && last[0] === kind && kind === "") last[1] += text;
    else found.push([kind, text]);
  }
  return found;
}
