// typing.js -- what keys do to a text besides writing: indentation and new lines, as changes.

/** A text with what is selected of it.
 *  @typedef {{text: string, start: number, end: number}} Selected */

/** What replaces a part of the text, and what is selected then.
 *  @typedef {{from: number, to: number, insert: string, start: number, end: number}} Change */

const INDENT = "    ";

/** Indent: spaces to the next stop, or each selected line by one.
 *  @param {Selected} now @returns {Change} */
export function indented({ text, start, end }) {
  if (!text.slice(start, end).includes("\n")) {
    const insert = " ".repeat(INDENT.length - ((start - lineStart(text, start)) % INDENT.length));
    return { from: start, to: end, insert, start: start + insert.length, end: start + insert.length };
  }
  return eachLine({ text, start, end }, (line) => (line.trim() ? INDENT + line : line));
}

/** Indent less: each selected line by one, as far as it is indented.
 *  @param {Selected} now @returns {Change} */
export function outdented(now) {
  return eachLine(now, (line) => line.replace(/^(?: {1,4}|\t)/, ""));
}

/** Begin a line: indented as the one before, one more behind an open bracket, whose partner goes below.
 *  @param {Selected} now @returns {Change} */
export function newLine({ text, start, end }) {
  const line = text.slice(lineStart(text, start), start), indent = (/^[ \t]*/.exec(line) || [""])[0];
  const before = line.replace(/\/\/.*/, "").trimEnd().at(-1) || "", after = text[end];
  if (!"{([".includes(before) || !before) return inserted(`\n${indent}`, start, end);
  const deeper = `\n${indent}${INDENT}`;
  const closes = after !== undefined && "})]"["{([".indexOf(before)] === after;
  return inserted(closes ? `${deeper}\n${indent}` : deeper, start, end, deeper.length);
}

/** Close a bracket: on a line that is blank so far it is indented as the line that opens it.
 *  @param {Selected} now @param {string} bracket
 *  @returns {Change | null} null: it is written as any letter */
export function closing({ text, start, end }, bracket) {
  const from = lineStart(text, start), blank = text.slice(from, start);
  if (blank.trim() || start !== end) return null;
  const opens = openedAt(text, from, "{(["["})]".indexOf(bracket)], bracket);
  if (opens < 0) return null;
  const begin = lineStart(text, opens), indent = (/^[ \t]*/.exec(text.slice(begin, opens)) || [""])[0];
  return { ...inserted(indent + bracket, from, end) };
}

/** Put the mark of a comment before each selected line, or take it from all that have it.
 *  @param {Selected} now @returns {Change} */
export function commented(now) {
  const from = lineStart(now.text, now.start), to = lineEnd(now);
  const lines = now.text.slice(from, to).split("\n").filter((line) => line.trim());
  const all = lines.every((line) => /^\s*\/\//.test(line));
  if (all) return eachLine(now, (line) => line.replace(/\/\/ ?/, ""));
  return eachLine(now, (line) => (line.trim() ? line.replace(/^(\s*)/, "$1// ") : line));
}

/** @param {string} insert @param {number} from @param {number} to @param {number} [caret]
 *  @returns {Change} */
function inserted(insert, from, to, caret = insert.length) {
  return { from, to, insert, start: from + caret, end: from + caret };
}

/** @param {string} text @param {number} at */
const lineStart = (text, at) => text.lastIndexOf("\n", at - 1) + 1;

/** Where the last selected line ends; one that only its beginning is selected of is not.
 *  @param {Selected} now */
function lineEnd({ text, start, end }) {
  const last = end > start && text[end - 1] === "\n" ? end - 1 : end;
  const found = text.indexOf("\n", last);
  return found < 0 ? text.length : found;
}

/** @param {Selected} now @param {(line: string) => string} change @returns {Change} */
function eachLine(now, change) {
  const from = lineStart(now.text, now.start), to = lineEnd(now);
  const lines = now.text.slice(from, to).split("\n"), changed = lines.map(change);
  const insert = changed.join("\n"), first = changed[0].length - lines[0].length;
  const start = Math.max(now.start + first, from);
  return { from, to, insert, start, end: Math.max(now.end + insert.length - (to - from), start) };
}

/** Where the bracket was opened that is open still; -1.
 *  @param {string} text @param {number} before @param {string} open @param {string} close */
function openedAt(text, before, open, close) {
  let depth = 0;
  for (let at = before - 1; at >= 0; at--) {
    if (text[at] === close) depth++;
    else if (text[at] === open && depth-- === 0) return at;
  }
  return -1;
}
