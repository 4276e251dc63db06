// written_parameters.js -- gives a sketch the parameters of a text that is edited in the page: a uniform that
// is typed has a row, and one that is taken out has none.

import { nearest } from "./complaints.js";
import { labelOf } from "./labels.js";
import { fits, isLog, lengthOf, WIDGETS } from "./numbers.js";
import { declaredUniforms, flatten } from "./source.js";
import { leavesOf } from "./values.js";

/** @import { Kernel, Leaf, Node, Shown, Sketch, Uniform, Value } from "./schema.js"
 *  @import { Line } from "./source.js" */

// ── Reads what a text says of its parameters behind //!: rows as Python makes them, of texts
// that are edited in a page. See playground/shader/header.py and playground/shader/declarations.py.

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

// ── Gives a sketch the parameters of a text that is edited in the page

/** What a text says of a kernel: its own parameters, and all names that are declared with those of includes.
 *  @typedef {{written: Written[], names: Set<string>}} Said */
/** By kernel; a kernel that does not read the file is not there. @typedef {Map<Kernel, Said>} Read */

/** Follow a file of a sketch, which is changed in place.
 *  @param {Sketch} sketch @param {import("./schema.js").Shared} shared @param {string} file
 *  @param {string} first  the file's text that the sketch's rows and values are of */
export function followParameters(sketch, shared, file, first) {
  const { kernels, nodes, values, shown } = sketch, before = readAll(first);
  let known = "";

  /** @param {string} text @returns {Read} */
  function readAll(text) {
    /** @type {Read} */
    const found = new Map();
    for (const kernel of kernels) {
      if (kernel.kind === "source" || kernel.kind === "plain_fragment") continue;
      const { lines } = flatten(shared, kernel.file, { [file]: text });
      if (!lines.some((line) => line.file === file)) continue;
      const names = new Set(declaredUniforms(lines).map(({ name }) => name));
      found.set(kernel, { written: writtenParameters(lines, file), names });
    }
    return found;
  }

  /** @param {Kernel} kernel @param {Said} said @returns {Kernel} */
  function kernelWith(kernel, { written, names }) {
    const own = new Set(written.map(({ uniform }) => uniform.name));
    const others = kernel.parameters.filter(({ name }) => names.has(name) && !own.has(name));
    return { ...kernel, parameters: [...others, ...written.map(({ uniform }) => uniform)] };
  }

  /** @param {Leaf} leaf @param {string} name */
  const pathOf = (leaf, name) => leaf.values[name] ?? `${leaf.path}.${name}`;

  /** @param {Node} node @param {Read} read @returns {Node} */
  function nodeWith(node, read) {
    if ("loop" in node) return { ...node, body: node.body.map((inside) => nodeWith(inside, read)) };
    const said = read.get(kernels[node.kernel]);
    if (!said) return node;
    const own = said.written.map(({ uniform: { name } }) => [name, pathOf(node, name)]);
    return { ...node, values: { ...node.values, ...Object.fromEntries(own) } };
  }

  /** A parameter has the value that its text says, unless the sketch sets another.
   *  @param {Leaf} leaf @param {Written} one */
  function valueOf(leaf, { uniform: { name }, facts }) {
    const set = values[pathOf(leaf, name)];
    const was = before.get(kernels[leaf.kernel])?.written.find(({ uniform }) => uniform.name === name);
    return set === undefined || JSON.stringify(set) === JSON.stringify(was?.facts.value) ? facts.value : set;
  }

  return {
    /** Read a text; throws an error with `file` and `line` for what cannot be read. @param {string} text */
    read: readAll,
    /** Give the sketch what a text says; returns whether its rows are others than before.
     *  @param {Read} read */
    take(read) {
      const rows = shown.map((row) => ({ ...row }));
      const now = { ...values };
      for (const leaf of leavesOf(nodes)) {
        const said = read.get(kernels[leaf.kernel]);
        if (!said) continue;
        for (const [name, path] of Object.entries(leaf.values)) {
          const at = rows.findIndex(({ targets }) => targets.length === 1 && targets[0] === path);
          if (!said.names.has(name) && at >= 0) rows.splice(at, 1);
        }
        for (const one of said.written) {
          const path = pathOf(leaf, one.uniform.name), value = valueOf(leaf, one);
          now[path] = value;
          const at = rows.findIndex((row) => row.path === path);
          const row = { ...one.facts, value, path, targets: [path] };
          const pass = path.split(".")[0], exported = leaf.path === pass;
          if (at >= 0) rows[at] = { ...rows[at], ...row };
          else rows.push({ ...row, pass, exported, main: 0, locked: "" });
        }
      }
      const text = JSON.stringify([rows, [...read.values()].map(({ written, names }) => [
        [...names], written.map(({ uniform }) => uniform),
      ])]);
      if (text === known) return false;
      known = text;
      sketch.kernels = kernels.map((kernel) => {
        const said = read.get(kernel);
        return said ? kernelWith(kernel, said) : kernel;
      });
      sketch.nodes = nodes.map((node) => nodeWith(node, read));
      sketch.values = now;
      sketch.shown = rows;
      return true;
    },
    /** The rows that the first text has none of, by path. */
    get added() {
      const old = new Set(shown.map(({ path }) => path));
      return sketch.shown.flatMap(({ path }) => (old.has(path) ? [] : [path]));
    },
  };
}
