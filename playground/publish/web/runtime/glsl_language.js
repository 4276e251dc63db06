// glsl_language.js -- GLSL for CodeMirror: the colours of its tokens, its comments, its indentation.

import { HighlightStyle, StreamLanguage, syntaxHighlighting } from "@codemirror/language";
import { tags } from "@lezer/highlight";

/** What a line begins in, and how far lines are indented that opened a bracket. Kinds of a directive:
 *  "directive", "pragma" one of the project's own; `quoted`: in the quotes of such a pragma, where "//" is a
 *  division.
 *  @typedef {{inside: "" | "comment" | "directive" | "pragma", quoted: boolean, open: number[]}} State */
/** @typedef {import("@codemirror/language").StringStream} Stream */

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
const NUMBER = /^(?:0[xX][0-9a-fA-F]*[uU]?|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?(?:[uUfF]|lf|LF)?)/;
const OWN_PRAGMA = /^\s*#\s*pragma\s+(?:kernel|source|draw|compute)\b/;

/** Pass a token; return what it is. @param {Stream} stream @param {State} state */
function token(stream, state) {
  if (state.inside === "comment") return comment(stream, state);
  if (stream.sol() && !state.inside && /^\s*#/.test(stream.string)) {
    state.inside = OWN_PRAGMA.test(stream.string) ? "pragma" : "directive";
  }
  if (state.inside) return directive(stream, state, state.inside);
  if (stream.eatSpace()) return null;
  if (stream.match("//!")) return rest(stream, "annotation");
  if (stream.match("//")) return rest(stream, "comment");
  if (stream.match("/*")) return comment(stream, state);
  if (stream.match(NUMBER)) return "number";
  const word = stream.match(/^[A-Za-z_]\w*/);
  if (word) {
    const name = stream.current();
    return KEYWORDS.has(name) ? "keyword" : TYPE.test(name) ? "type" : BUILTIN.test(name) ? "builtin" : null;
  }
  const sign = stream.next() ?? "";
  if ("{([".includes(sign)) state.open.push(stream.indentation());
  if ("})]".includes(sign)) state.open.pop();
  return null;
}

/** @param {Stream} stream @param {string} kind */
function rest(stream, kind) {
  stream.skipToEnd();
  return kind;
}

/** @param {Stream} stream @param {State} state */
function comment(stream, state) {
  state.inside = stream.skipTo("*/") && stream.match("*/") ? "" : "comment";
  if (state.inside) stream.skipToEnd();
  return "comment";
}

/** A directive up to its end or a comment; a backslash carries it on to the next line.
 *  @param {Stream} stream @param {State} state @param {"directive" | "pragma"} kind */
function directive(stream, state, kind) {
  let last = "";
  while (!stream.eol()) {
    if (!state.quoted && stream.match(/^\/[/*]/, false)) break;
    last = stream.next() ?? "";
    if (last === '"' && kind === "pragma") state.quoted = !state.quoted;
  }
  if (!stream.eol() || last !== "\\") Object.assign(state, { inside: "", quoted: false });
  return kind;
}

/** The language, without colours. @type {StreamLanguage<State>} */
export const glslLanguage = StreamLanguage.define({
  name: "glsl",
  startState: () => ({ inside: "", quoted: false, open: [] }),
  copyState: ({ inside, quoted, open }) => ({ inside, quoted, open: [...open] }),
  token,
  indent: ({ open }, after, { unit }) =>
    (open.length ? open[open.length - 1] + (/^\s*[})\]]/.test(after) ? 0 : unit) : 0),
  languageData: {
    commentTokens: { line: "//", block: { open: "/*", close: "*/" } }, indentOnInput: /^\s*[})\]]$/,
  },
  tokenTable: {
    comment: tags.comment, annotation: tags.docComment, directive: tags.processingInstruction,
    pragma: tags.annotation, keyword: tags.keyword, type: tags.typeName,
    builtin: tags.standard(tags.function(tags.name)), number: tags.number,
  },
});

/** Its colours, as classes. */
export const glslColours = HighlightStyle.define([
  { tag: tags.comment, class: "comment" }, { tag: tags.docComment, class: "annotation" },
  { tag: tags.processingInstruction, class: "directive" }, { tag: tags.annotation, class: "pragma" },
  { tag: tags.keyword, class: "keyword" }, { tag: tags.typeName, class: "type" },
  { tag: tags.standard(tags.function(tags.name)), class: "builtin" }, { tag: tags.number, class: "number" },
]);

export const glsl = [glslLanguage, syntaxHighlighting(glslColours)];
