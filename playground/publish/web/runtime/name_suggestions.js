// name_suggestions.js -- what a name was meant to be that a driver does not know.

import { WORDS } from "./complaint_words.js";

/** @typedef {import("./complaints.js").FlatLine} FlatLine */
/** @typedef {import("./complaints.js").LogEntry} LogEntry */
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
export function withoutConsequences(entries) {
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
