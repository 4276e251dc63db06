// complaints.js -- a driver's log as errors in the kernel's own files, in plain words.

import WORDS from "./complaint_words.json" with { type: "json" };

// ── What a name was meant to be that a driver does not know.

/** Names that a text declares: functions with the first line of each, variables and macros.
 *  @typedef {{functions: Map<string, number>, variables: Set<string>}} Declared */

/** Fill a sentence's places {0} and {1}.
 *  @param {string} sentence @param {...string} given @returns {string} */
export const filled = (sentence, ...given) => sentence.replace(/\{(\d)\}/g, (_, i) => given[+i])
  .replaceAll("{{", "{").replaceAll("}}", "}");

/** @param {string[]} pattern @param {string} [more] @returns {RegExp} */
const compiled = ([source, flags], more = "") => new RegExp(source, flags + more);

const FOLLOWS = compiled(WORDS.follows), UNFIT = compiled(WORDS.unfit);
const UNKNOWN = compiled(WORDS.unknown), UNREAD = compiled(WORDS.unread), CAST = compiled(WORDS.cast);
const DEFINE = compiled(WORDS.define), RUNS = compiled(WORDS.runs);
const FUNCTION = compiled(WORDS.function, "g"), VARIABLE = compiled(WORDS.variable, "g");
const DEFINITION = compiled(WORDS.definition, "g");
const KNOWN = new Set(WORDS.known.split(" "));
const ELSEWHERE = new Map(Object.entries(WORDS.elsewhere));
const INSTEAD = new Map(Object.entries(WORDS.instead));

/** @param {string} message @returns {string} its first line */
const headOf = (message) => message.split("\n")[0].slice(0, 600);

/** @param {string} head @returns {string} the name that a message calls unknown; "" for any other */
const unknown = (head) => UNKNOWN.exec(head)?.slice(1).find(Boolean) || "";

/** Leave out what follows from an unknown name, and all but the first entry of each.
 *  @param {LogEntry[]} entries @returns {LogEntry[]} */
function withoutConsequences(entries) {
  const seen = new Set();
  let [line, column] = [0, 0];  // of the cause
  return entries.filter((entry) => {
    const head = headOf(entry.message);
    const isBehind = entry.line > line || (entry.line === line && entry.column > column);
    const follows = entry.line > 0 && !isBehind && FOLLOWS.test(head);
    const name = follows ? "" : unknown(head), isRepeated = seen.has(name);
    if (name || (UNFIT.test(head) && !follows)) [line, column] = [entry.line, entry.column];
    if (name) seen.add(name);
    return entry.severity !== "error" || !(follows || isRepeated);
  });
}

/** Say in one sentence what an unknown name was meant to be; "" where that is not sure.
 *  @param {string} message   a driver's
 *  @param {FlatLine[]} lines the whole flat text
 *  @param {FlatLine | null} line   where it points
 *  @param {Object<string, string>} library   function → the files to include for it, in quotes
 *  @returns {string} */
export function guess(message, lines, line, library) {
  const head = headOf(message), say = WORDS.guesses;
  const name = unknown(head);
  if (!name) return line && UNREAD.test(head) ? unread(lines, line) : "";
  const call = new RegExp(`\\b${name}\\s*\\(`);
  const called = line ? call.test(line.code) : lines.some(({ code }) => call.test(code));
  const { functions, variables } = declared(lines);
  if (functions.has(name) || variables.has(name)) {
    const there = functions.get(name), here = line ? lines.indexOf(line) : -1;
    if (!called || there === undefined || here < 0 || there <= here) return "";
    return filled(say.below, name, `${lines[there].file}:${lines[there].line}`);
  }
  if (KNOWN.has(name)) return "";
  if (ELSEWHERE.has(name)) return filled(say.elsewhere, name, ELSEWHERE.get(name) || "");
  if (name === "saturate" && called) return say.saturate;
  if (INSTEAD.has(name) && functions.has("kernel")) return filled(say.instead, name, INSTEAD.get(name) || "");
  if (Object.hasOwn(library, name)) return filled(say.library, name, library[name]);
  const more = called ? KNOWN : [...variables, ...WORDS.given];
  const near = nearest(name, new Set([...functions.keys(), ...more]));
  return near ? filled(say.near, name, near) : "";
}

/** Return what to include for each function that a page's library files define.
 *  @param {Object<string, string>} files  texts by name; a sketch's own begin with "./"
 *  @returns {Object<string, string>} */
export function libraryOf(files) {
  /** @type {Map<string, string[]>} */
  const found = new Map();
  for (const file of Object.keys(files).sort()) {
    if (!file.endsWith(".glsl") || file.startsWith("./") || RUNS.test(files[file])) continue;
    for (const name of new Set([...files[file].matchAll(DEFINITION)].map((match) => match[1]))) {
      found.set(name, [...(found.get(name) || []), `\`#include "${file}"\``]);
    }
  }
  return Object.fromEntries([...found].map(([name, which]) => [name, which.slice(0, 3).join(" or ")]));
}

/** @param {FlatLine[]} lines @param {FlatLine} line @returns {string} */
function unread(lines, line) {
  const cast = CAST.exec(line.code), say = WORDS.guesses;
  if (cast) return filled(say.cast, cast[1]);
  const { functions, variables } = declared(lines);
  for (const [word] of line.code.matchAll(/[A-Za-z_]\w*/g)) {
    if (functions.has(word) || variables.has(word) || KNOWN.has(word) || WORDS.given.includes(word)) continue;
    if (ELSEWHERE.has(word)) return filled(say.elsewhere, word, ELSEWHERE.get(word) || "");
    const times = lines.reduce((sum, { code }) => sum + code.split(word).length - 1, 0);
    const near = times === 1 ? nearest(word, new Set(WORDS.types)) : "";
    if (near) return filled(say.type, word, near);
  }
  return "";
}

/** @param {FlatLine[]} lines @returns {Declared} */
function declared(lines) {
  const functions = new Map(), variables = new Set();
  lines.forEach(({ code }, at) => {
    if (!code.trim()) return;
    for (const match of code.matchAll(FUNCTION)) if (!functions.has(match[1])) functions.set(match[1], at);
    for (const match of code.matchAll(VARIABLE)) variables.add(match[1]);
    const macro = DEFINE.exec(code);
    if (macro && macro[2] && !functions.has(macro[1])) functions.set(macro[1], at);
    else if (macro && !macro[2]) variables.add(macro[1]);
  });
  return { functions, variables };
}

/** Return the one known name that is like this one; "" where there is none, or two are as near.
 *  @param {string} name @param {Set<string>} known @returns {string} */
export function nearest(name, known) {
  const folded = [...known].filter((other) => other.toLowerCase() === name.toLowerCase());
  if (folded.length === 1 && folded[0] !== name) return folded[0];
  if (name.length < 3) return "";
  const scored = [...known].map((other) => ({ other, score: likeness(other, name) }))
    .filter(({ score }) => score >= WORDS.near)
    .sort((a, b) => b.score - a.score || (a.other < b.other ? 1 : -1));
  if (scored.length > 1) {
    const [first, second] = scored.map(({ other }) => likeness(name, other));
    if (first === second) return "";
  }
  return scored.length ? scored[0].other : "";
}

/** How alike two words are, 0 to 1: twice the letters in common blocks over all letters (Ratcliff and
 *  Obershelp 1988), as Python's difflib has it.
 *  @param {string} a @param {string} b @returns {number} */
export function likeness(a, b) {
  return a.length + b.length ? (2 * inCommon(a, b)) / (a.length + b.length) : 1;
}

/** @param {string} a @param {string} b @returns {number} */
function inCommon(a, b) {
  let best = 0, inA = 0, inB = 0;
  for (let i = 0; i < a.length; i++) {
    for (let j = 0; j < b.length; j++) {
      let size = 0;
      while (i + size < a.length && j + size < b.length && a[i + size] === b[j + size]) size++;
      if (size > best) [best, inA, inB] = [size, i, j];
    }
  }
  if (!best) return 0;
  const before = inCommon(a.slice(0, inA), b.slice(0, inB));
  return before + best + inCommon(a.slice(inA + best), b.slice(inB + best));
}

// ── A driver's log as errors in the kernel's own files, in plain words

/** A line of a flat text: what the driver is given, and where it is from.
 *  @typedef {{code: string, file: string, line: number}} FlatLine */

/** What is wrong, and where; line 0: it is known of the file alone.
 *  @typedef {{file: string, line: number, column: number, message: string, kernel: string,
 *             severity: "error" | "warning"}} Complaint */

/** @typedef {{line: number, column: number, severity: "error" | "warning", message: string}} LogEntry */

/** @param {string[]} pattern @returns {RegExp} */
const whole = ([source, flags]) => new RegExp(`^(?:${source})$`, flags);
/** @param {string[]} pattern @param {string} [more] @returns {RegExp} */
const some = ([source, flags], more = "") => new RegExp(source, flags + more);

const FORMATS = WORDS.formats.map(whole);
const [BENIGN, FRAME, SUMMARY] = [WORDS.benign, WORDS.frame, WORDS.summary].map(whole);
const HINTS = WORDS.hints.map(([source, flags, sentence]) => ({ pattern: some([source, flags]), sentence }));
const MISFIT = some(WORDS.misfit), CALL = some(WORDS.call);
const DEFINED = some(WORDS.defined), CHAIN = some(WORDS.chain);
const TYPE = some(WORDS.type, "g");
const UNBROKEN = some(WORDS.unbroken, "g");

/** Read the log of a compiler or a linker. Entries keep its order; summaries stay where they are alone.
 *  @param {string} log
 *  @returns {LogEntry[]} */
export function parseLog(log) {
  const lines = log.replaceAll("\0", "").replace(/\r\n?/g, "\n").replace(UNBROKEN, "\n").split("\n");
  /** @type {{entry: LogEntry, known: boolean}[]} */
  const drafts = [];
  for (const raw of lines) {
    const line = raw.trim();
    if (line && !BENIGN.test(line) && !FRAME.test(line)) take(drafts, line, /^\s/.test(raw));
  }
  const telling = drafts.filter(({ entry }) => !SUMMARY.test(entry.message.split("\n")[0]));
  const all = (telling.length ? telling : drafts).map(({ entry }) => entry);
  return [...new Map(all.map((one) => [JSON.stringify(one), one])).values()];
}

/** @param {{entry: LogEntry, known: boolean}[]} drafts @param {string} line @param {boolean} indented */
function take(drafts, line, indented) {
  const entry = recognised(line), last = drafts.at(-1);
  if (entry) {
    const same = last && last.entry.line === entry.line && last.entry.column === entry.column &&
      last.entry.severity === entry.severity;
    const head = last ? last.entry.message.split("\n")[0] : "";
    if (last && same && head.endsWith("candidates are:") && line.includes(":    ")) {
      last.entry.message += `\n    ${entry.message}`;
    } else if (last && same && entry.message.startsWith("... ")) {
      last.entry.message += ` ${entry.message}`;
    } else drafts.push({ entry, known: true });
    return;
  }
  const head = clean(line);
  const alone = !last || (last.known && !indented) || SUMMARY.test(head) || SUMMARY.test(last.entry.message);
  if (alone) drafts.push({ entry: { line: 0, column: 0, severity: "error", message: head }, known: false });
  else last.entry.message += `\n    ${head}`;
}

/** @param {string} line @returns {LogEntry | null} */
function recognised(line) {
  for (const format of FORMATS) {
    const groups = format.exec(line)?.groups;
    if (!groups) continue;
    const kind = (groups.kind || "error").toLowerCase();
    return {
      line: Math.max(0, Number(groups.line || 0)),
      column: Number(groups.column || 0),
      severity: kind.includes("error") ? "error" : "warning",
      message: clean(groups.message || "") || kind,
    };
  }
  return null;
}

/** @param {string} message @returns {string} */
function clean(message) {
  const text = message.split(/\s+/).filter(Boolean).join(" ").replace(/^(?:'' ?: ?|Error: )/, "");
  return text.replace(/\b(syntax error):? (?:\1|parse error)$/, "$1");
}

/** Say in one sentence what a message usually means; "" where nothing useful is known.
 *  @param {string} message
 *  @returns {string} */
export function hint(message) {
  const head = message.split("\n")[0].slice(0, 600);
  for (const { pattern, sentence } of HINTS) {
    const found = pattern.exec(head);
    if (!found) continue;
    const name = found.slice(1).find(Boolean) || "";
    return filled(sentence, name, name.toLowerCase());
  }
  return MISFIT.test(head) && !/\berror\b/.test(head) ? misfit(head) : "";
}

/** @param {string} head @returns {string} */
function misfit(head) {
  const call = CALL.exec(head), say = WORDS.misfits;
  if (call) {
    const name = call[1] || call[3], given = call[2] || "";
    const isWhole = types(given).some(([base]) => base === "int" || base === "uint");
    return isWhole ? filled(say["whole call"], name, given) : filled(say.call, name);
  }
  const found = types(head), bases = new Set(found.map(([base]) => base));
  if (bases.size > 1 && bases.has("bool")) return say.bool;
  if (bases.size > 1 && bases.has("float")) return say.float;
  if (bases.size === 2) return say.sign;
  const sizes = new Set(found.map(([, size]) => size));
  return sizes.size > 1 || head.includes("mismatch") ? say.size : say.types;
}

/** @param {string} text @returns {[string, string][]} of each type in it: kind of number, size */
function types(text) {
  return [...text.matchAll(TYPE)].map(({ groups }) => {
    const { word, size } = /** @type {Object<string, string>} */ (groups);
    const found = word.includes("mat") ? word.slice(word.indexOf("mat")) : word.includes("vec")
      ? /** @type {string} */ (word.at(-1)) : size || "1";
    const first = word.startsWith("uns") ? "u" : word[0];
    return [/** @type {Object<string, string>} */ (WORDS.bases)[first], found];
  });
}

/** What the text that a driver was given is made of.
 *  @typedef {object} Given
 *  @property {number} first        line of the stage's text, from 1, that the kernel's first line is on
 *  @property {FlatLine[]} lines    the kernel's flat text
 *  @property {string} file         the kernel's own file
 *  @property {string} kernel       its name
 *  @property {string} [expected]   what the file is to define, for what is found behind its end
 *  @property {(file: string) => string | undefined} [text]   of a file, as it is written
 *  @property {Object<string, string>} [library]   function → what to include for it: libraryOf */

/** Return the complaints of a log, each at its line of the kernel's files; never a line of the wrapper.
 *  @param {string} log  of one stage, or of the linker
 *  @param {Given} given
 *  @returns {Complaint[]} */
export function complaints(log, given) {
  /** @type {Map<string, Complaint>} */
  const found = new Map();
  for (const entry of withoutConsequences(parseLog(log))) {
    const one = located(entry, given);
    // An open bracket makes everything behind the last line wrong: once is enough.
    const past = entry.line >= given.first + given.lines.length && entry.severity === "error";
    const key = [one.file, one.line, past ? "" : one.message].join("\n");
    if (!found.has(key)) found.set(key, one);
  }
  if ([...found.values()].some(({ severity }) => severity === "error")) return [...found.values()];
  const message = log.trim() || "the driver refused the shader and gave no reason";
  return [{ file: given.file, line: 0, column: 0, message, kernel: given.kernel, severity: "error" }];
}

/** @param {LogEntry} entry @param {Given} given @returns {Complaint} */
function located(entry, { first, lines, file, kernel, expected, text, library }) {
  const { severity } = entry;
  const fetches = Object.entries(WORDS.fetches).sort().reverse();  // the longer first
  const message = fetches.reduce((text, [name, ours]) => text.replaceAll(ours, name), entry.message);
  const index = entry.line ? entry.line - first : defined(message, lines);
  const line = index >= 0 ? lines[index] : undefined;
  if (line) {
    const raw = text?.(line.file)?.split("\n")[line.line - 1] ?? "";
    const at = severity === "error" ? beyondAscii(line.code, raw) : -1;
    const more = at < 0 ? guess(message, lines, line, library || {}) || hint(message) : "";
    const told = at < 0 ? (more ? `${message}; ${more}` : message) : foreign(raw, at);
    const column = at < 0 ? columnOf(message, line.code) : at + 1;
    return { file: line.file, line: line.line, column, message: told, kernel, severity };
  }
  if (index >= lines.length) {
    const last = [...lines].reverse().find(({ code }) => code.trim()) || lines[lines.length - 1];
    const whole = filled(WORDS.pastEnd, message, expected || "");
    const told = expected ? whole : whole.slice(0, whole.lastIndexOf("?") + 1);
    return { file: last.file, line: last.line, column: 0, message: told, kernel, severity };
  }
  const more = guess(message, lines, null, library || {}) || hint(message);
  return { file, line: 0, column: 0, message: more ? `${message}; ${more}` : message, kernel, severity };
}

/** @param {string} raw @param {number} at @returns {string} what is said of a character beyond ASCII */
function foreign(raw, at) {
  const code = /** @type {number} */ (raw.codePointAt(at)), names = new Map(Object.entries(WORDS.characters));
  const name = names.get(String.fromCodePoint(code)) || WORDS.nameless;
  return filled(WORDS.foreign, code.toString(16).toUpperCase().padStart(4, "0"), name);
}

/** @param {string} code @param {string} raw
 *  @returns {number} where a line has a character that the driver was given as "?"; -1 */
function beyondAscii(code, raw) {
  for (let at = 0; at < code.length; at++) if (code[at] === "?" && raw.charCodeAt(at) > 127) return at;
  return -1;
}

/** The line on which a function is defined that a message without a line names, as a linker's does.
 *  @param {string} message @param {FlatLine[]} lines @returns {number} */
function defined(message, lines) {
  const match = DEFINED.exec(message), chain = CHAIN.exec(message);
  if (!match && !chain) return -1;
  const begins = match ? `\\b${match[1]}\\s+${match[2]}\\s*\\(` : `^\\s*\\w+\\s+${chain?.[1]}\\s*\\(`;
  return lines.findIndex(({ code }) => new RegExp(begins).test(code));
}

/** @param {string} message @param {string} code @returns {number} of the name that a message quotes; 0 */
function columnOf(message, code) {
  for (const [, name] of message.matchAll(/[`'"]([A-Za-z_]\w*)['"]/g)) {
    const at = code.search(new RegExp(`\\b${name}\\b`));
    if (at >= 0) return at + 1;
  }
  return 0;
}
