// annotations.js -- reads what a text says of its parameters behind //!: rows as Python makes them, of texts
// that are edited in a page. See playground/shader/header.py and playground/shader/declarations.py.

import { labelOf } from "./labels.js";
import { lengthOf } from "./numbers.js";
import { nearest } from "./name_suggestions.js";
import { declaredUniforms } from "./uniforms.js";
import { fits } from "./value_text.js";
import { WIDGETS, isLog } from "./widgets.js";

/** @typedef {import("./source.js").Line} Line */
/** @typedef {import("./schema.js").Value} Value */
/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Uniform} Uniform */
/** What is true of a parameter wherever its kernel stands: its uniform, and of its row all but its place.
 *  @typedef {Pick<Shown, "label" | "group" | "description" | "widget" | "type" | "ranges" | "step" | "unit"
 *            | "choices" | "parts" | "raw" | "value">} Facts */
/** @typedef {{uniform: Uniform, facts: Facts, line: Line}} Written */

const SAMPLER = { types: "sampler2D", control: "" }; // an input
const ROLES = [...Object.keys(WIDGETS).filter((word) => word !== "number"), "input"];
const MODIFIERS = ["step", "unit", "group", "label", "parts", "values", "follows", "erode", "preview"];
const WORDS = [...ROLES, ...MODIFIERS];
const BARE = ROLES.filter((word) => !["range", "choices"].includes(WIDGETS[word]?.takes ?? ""));
const ANNOTATION = /^\s*\/\/!(.*)$/;
const WORD = /\s*([A-Za-z_]\w*)(\s*\()?/y;
const ARGUMENT = /\s*("(?:[^"\\]|\\.)*"|[^,()"]+)\s*(,|$)/y;

/** The parameters that a file of a flat text declares, but for textures. Throws an error with `file` and
 *  `line` for one that cannot be read.
 *  @param {Line[]} lines @param {string} file @returns {Written[]} */
export function writtenParameters(lines, file) {
  return declaredUniforms(lines).flatMap((one) => {
    if (one.file !== file || one.value === null) return [];
    const index = lines.findIndex((line) => line.file === file && line.line === one.line);
    return [parameterOf(one.name, one.type, one.value, noteAt(lines, index), lines[index])];
  });
}

/** The annotation that begins on a line, with the lines after it that hold nothing else.
 *  @param {Line[]} lines @param {number} index */
function noteAt(lines, index) {
  const parts = [];
  for (let at = index; at < lines.length; at++) {
    const { code, raw, file } = lines[at], found = ANNOTATION.exec(raw.slice(code.length));
    if (!found || (at > index && (code || file !== lines[index].file))) break;
    parts.push(found[1].trim());
  }
  return parts.join(" ");
}

/** @param {Line} line @param {string} message */
const errorAt = ({ file, line }, message) => Object.assign(new Error(message), { file, line });

/** The calls of a note with their arguments, and the tooltip that follows them.
 *  @param {string} note @param {Line} line @returns {{calls: Map<string, string[]>, tooltip: string}} */
function callsOf(note, line) {
  const calls = new Map();
  let position = 0;
  for (;;) {
    WORD.lastIndex = position;
    const match = WORD.exec(note);
    if (!match) break;
    const [all, word, opens] = match;
    if (!WORDS.includes(word)) {
      const near = opens ? nearest(word, new Set(WORDS)) : "";
      if (opens && (position === 0 || near)) {
        throw errorAt(line, `no widget '${word}'${near ? `; did you mean '${near}'?` : ""}`);
      }
      break;
    }
    if (!opens) {
      if (position || !BARE.includes(word)) break;
      calls.set(word, []);
      position += all.length;
      continue;
    }
    if (calls.has(word)) throw errorAt(line, `'${word}' appears twice`);
    const end = closing(note, position + all.length);
    if (end < 0) throw errorAt(line, `'${word}(' is not closed`);
    calls.set(word, argumentsOf(note.slice(position + all.length, end), line));
    position = end + 1;
  }
  return { calls, tooltip: note.slice(position).trim() };
}

/** Where a bracket closes, those in quotes apart; -1 if it does not.
 *  @param {string} text @param {number} from */
function closing(text, from) {
  const part = /"(?:[^"\\]|\\.)*"|\)/g;
  part.lastIndex = from;
  for (let match = part.exec(text); match; match = part.exec(text)) if (match[0] === ")") return match.index;
  return -1;
}

/** @param {string} text @param {Line} line @returns {string[]} */
function argumentsOf(text, line) {
  const found = [], whole = text.trimEnd();
  for (let position = 0; position < whole.length;) {
    ARGUMENT.lastIndex = position;
    const match = ARGUMENT.exec(whole);
    if (!match?.[1].trim()) {
      const rest = whole.slice(position).trim();
      throw errorAt(line, `cannot read '${rest}'; expected values separated by commas, text in quotes`);
    }
    const raw = match[1].trim();
    found.push(raw.startsWith('"') ? raw.slice(1, -1).replace(/\\(.)/g, "$1") : raw);
    position = ARGUMENT.lastIndex;
  }
  return found;
}

/** @param {string} name @param {string} type @param {Value} initial @param {string} note @param {Line} line
 *  @returns {Written} */
function parameterOf(name, type, initial, note, line) {
  const { calls, tooltip } = callsOf(note, line), words = ROLES.filter((word) => calls.has(word));
  if (words.length > 1) throw errorAt(line, `'${name}' has two widgets: ${words.join(" and ")}`);
  const widget = words[0] ?? (type === "bool" ? "checkbox" : "number");
  const kind = WIDGETS[widget] ?? SAMPLER;
  if (!kind.types.split(" ").includes(type)) {
    throw errorAt(line, `${widget} does not suit '${name}', a ${type}`);
  }
  const given = calls.get(widget) ?? [], count = lengthOf(type);
  const text = (/** @type {string} */ word) => calls.get(word)?.[0] ?? "";
  const step = calls.has("step") ? numbersOf(name, "step", calls.get("step") ?? [], 1, line)[0] : null;
  if (step !== null && step <= 0) throw errorAt(line, `step of '${name}': expected a number above 0`);
  const names = calls.get("parts") ?? (count === 1 ? [] : (kind.parts ?? [..."xyzw"]).slice(0, count));
  const values = calls.get("values")?.map(Number);
  /** @type {Facts} */
  const facts = {
    label: text("label") || labelOf(name), group: text("group"), description: tooltip, widget, type,
    ranges: rangesOf(name, widget, given, Math.max(names.length, 1), line), step,
    unit: text("unit") || (kind.unit ?? ""), choices: widget === "menu" ? given : [], parts: names,
    value: values ? values.indexOf(Number(initial)) : initial,
    ...(widget === "colour" && given[0] === "raw" ? { raw: true } : {}),
  };
  if (widget === "menu" && given.length < 2) {
    throw errorAt(line, `the menu of '${name}' needs its choices, as menu("linear", "smooth")`);
  }
  const isInside = fits(/** @type {Shown} */ ({ path: "", ...facts }), facts.value);
  if (!isInside) throw errorAt(line, `the default of '${name}' is ${initial}, which it may not be`);
  return { uniform: { name, type, widget, ...(values ? { values } : {}) }, facts, line };
}

/** The range of each number; [null, null] where there is none.
 *  @param {string} name @param {string} widget @param {string[]} given in brackets @param {number} count
 *  @param {Line} line @returns {[number | null, number | null][]} */
function rangesOf(name, widget, given, count, line) {
  const { takes = "", range, spans } = WIDGETS[widget];
  const pair = (/** @type {string[]} */ some) =>
    /** @type {[number, number]} */ (numbersOf(name, widget, some, 2, line));
  const each = (/** @type {[number | null, number | null]} */ ends) =>
    Array.from({ length: count }, () => /** @type {[number | null, number | null]} */ ([...ends]));
  if (spans) return spans;
  if (takes === "ranges" && given.length > 2) return [pair(given.slice(0, 2)), pair(given.slice(2))];
  if (takes === "range" || ["range or nothing", "ranges"].includes(takes) && given.length) {
    const ends = pair(given);
    if (!isLog(widget) || ends[0] > 0) return each(ends);
    throw errorAt(line, `${widget} of '${name}': its range must lie above 0`);
  }
  if (given.length && !takes) throw errorAt(line, `${widget} of '${name}' takes nothing in brackets`);
  return each(range ?? [null, null]);
}

/** @param {string} name @param {string} word @param {string[]} given @param {number} count
 *  @param {Line} line */
function numbersOf(name, word, given, count, line) {
  const numbers = given.map((text) => (text.trim() ? Number(text) : NaN));
  const good = numbers.length === count && numbers.every(Number.isFinite)
    && (count === 1 || numbers[0] < numbers[1]);
  if (good) return numbers;
  const wanted = count === 2 ? `two numbers, the lower first, as ${word}(0, 1)` : "one number, as step(0.01)";
  throw errorAt(line, `${word} of '${name}': expected ${wanted}`);
}
