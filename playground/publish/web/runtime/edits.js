// edits.js -- edited texts: their kernels are compiled, what is wrong is told by line.

import { complaints, libraryOf } from "./complaints.js";
import { readKernel, stagesOf } from "./kernel_texts.js";

/** @import { KernelText } from "./kernel_texts.js"
 *  @import { Kernel } from "./schema.js"
 *  @import { Flat } from "./source.js" */

// ── Finds a kernel's function that has not the form its header asks for: shader/wrap.py.
//
// A driver would complain of the lines that call it, which no author has written.

const PRAGMA = /^\s*#\s*pragma\s+(?:kernel|draw|compute)\b/;
const QUALIFIERS = ["const", "highp", "mediump", "lowp"];
const EXAMPLES = [
  ["vertex", "vec4 vertex(vec3 corner, out vec3 position)"], ["fragment", "vec4 fragment(vec3 position)"],
];

/** Throws an error with `file` and `line` where a kernel or a draw has no function as its header asks for, or
 *  reads an iteration before where there is none.
 *  @param {Pick<Kernel, "kind" | "outputs" | "repeat">} kernel @param {Flat} flat */
export function checkSignature({ kind, outputs, repeat }, flat) {
  if (kind === "draw") {
    for (const [name, example] of EXAMPLES) {
      const type = definition(flat, name)?.type, several = name === "fragment" && outputs.length > 1;
      if (several && type) checkOutputs(outputs, flat);
      else if (type !== "vec4") throw unsigned(flat, `a draw needs a function ${example}`);
    }
  }
  if (kind === "kernel") {
    checkKernel(outputs, flat);
    checkPrevious(outputs, repeat === 1, flat);
  }
}

/** @param {Kernel["outputs"]} outputs @param {Flat} flat */
function checkKernel(outputs, flat) {
  const single = outputs.length === 1;
  const types = outputs.map(({ format }) => (
    format.startsWith("rgba") ? "vec4" : format.startsWith("rg") ? "vec2" : "float"));
  const outs = outputs.map(({ name }, k) => `out ${types[k]} ${name}`);
  const signature = single ? `${types[0]} kernel(ivec2 texel)`
    : `void kernel(ivec2 texel, ${outs.join(", ")})`;
  const found = definition(flat, "kernel");
  if (!found) throw unsigned(flat, `there is no function ${signature}`);
  const given = found.parts.map(argument);
  const wanted = ["in ivec2", ...(single ? [] : types.map((type) => `out ${type}`))];
  const fits = given.map(({ way, type }) => `${way} ${type}`).join() === wanted.join();
  if (found.type !== (single ? types[0] : "void") || !fits) {
    throw unsigned(flat, `kernel must be ${signature}`, found.line);
  }
  if (!single && given.slice(1).some(({ name }, k) => name !== outputs[k].name)) {
    throw unsigned(flat, `kernel must be ${signature}: its outputs in the order of the pragma`, found.line);
  }
}

/** The fragment function of a draw with several outputs.
 *  @param {Kernel["outputs"]} outputs @param {Flat} flat */
function checkOutputs(outputs, flat) {
  const found = definition(flat, "fragment"), wanted = outputs.map(({ name }) => `out vec4 ${name}`);
  if (!found) return;
  const signature = `fragment must be void fragment(…, ${wanted.join(", ")})`;
  if (found.type !== "void") throw unsigned(flat, signature, found.line);
  const given = found.parts.map(argument).map(({ way, type, name }) => `${way} ${type} ${name}`);
  if (given.slice(-wanted.length).join() === wanted.join()) return;
  throw unsigned(flat, `${signature}: its outputs last, in the order of the pragma`, found.line);
}

/** @param {Kernel["outputs"]} outputs @param {boolean} once @param {Flat} flat */
function checkPrevious(outputs, once, flat) {
  const longs = outputs.map(({ name }) => `previous_${name}`);
  const names = outputs.length === 1 ? ["previous"] : longs;
  flat.lines.forEach(({ code }, index) => {
    for (const [, called] of code.matchAll(/\b(previous(?:_\w+)?)\s*\(/g)) {
      if (names.includes(called) && once) {
        const message = `${called} is the iteration before, but the kernel has one only; give it a repeat`;
        throw unsigned(flat, message, index);
      }
      if (!names.includes(called) && ["previous", ...longs].includes(called)) {
        throw unsigned(flat, `the iteration before is read by ${names.join(" and ")}, not ${called}`, index);
      }
    }
  });
}

/** The first definition of a function: its type, its arguments, and on which of the lines it begins.
 *  @param {Flat} flat @param {string} name */
function definition({ lines }, name) {
  const code = lines.map((line) => line.code).join("\n");
  const match = new RegExp(`\\b(\\w+)\\s+${name}\\s*\\(([^)]*)\\)\\s*\\{`).exec(code);
  return match && {
    type: match[1], parts: match[2].split(","), line: code.slice(0, match.index).split("\n").length - 1,
  };
}

/** @param {string} text */
function argument(text) {
  const words = text.split(/\s+/).filter((word) => word && !QUALIFIERS.includes(word));
  const way = ["in", "out", "inout"].includes(words[0]) ? words.shift() : "in";
  const [type = "", name = "", ...more] = words;
  return { way, type: more.length ? text.trim() : type, name };
}

/** An error at one of the lines, or at the header.
 *  @param {Flat} flat @param {string} message @param {number} [index] */
function unsigned({ lines }, message, index = Math.max(lines.findIndex(({ raw }) => PRAGMA.test(raw)), 0)) {
  const { file, line } = lines[index];
  return Object.assign(new Error(message), { file, line });
}

// ── Tries an edited text: all kernels that it is part of are compiled, and what is wrong is told
// by line.

/** @typedef {{file: string, line: number, column?: number, message: string, kernel: string}} Complaint
 *  line 0: of no line */
/** @typedef {{errors: Complaint[], programs: number}} Edit  programs: how many were compiled */

/** Compile what edited texts change; nothing else changes.
 *  @param {import("./engine.js").Engine} engine @param {Kernel[]} all
 *  @param {(kernel: Kernel) => KernelText} before
 *  @param {Object<string, string>} texts @returns {Promise<Edit & {kernels: KernelText[]}>} */
export const tried = async (engine, all, before, texts) => {
  const { kernels, programs } = engine.parts;
  /** @type {Complaint[]} */
  const errors = [];
  /** @type {{text: KernelText, program: import("./programs.js").Program}[]} */
  const asked = [];
  const compiled = programs.compiled;
  for (const kernel of all) {
    if (kernel.kind === "source") continue;
    try {
      const text = readKernel(engine.shared, kernel, texts), was = before(kernel);
      checkSignature(kernel, text.flat);
      if (text.identity === was.identity) continue;
      const hands = was.hands.size ? [...was.hands.values()] : [new Map()];
      for (const byHand of hands) asked.push({ text, program: kernels.ask(text, byHand) });
    } catch (error) {
      const { message, file = kernel.file, line = 0 } = /** @type {any} */ (error);
      errors.push({ file, line, message, kernel: kernel.name });
    }
  }
  await programs.wait(asked.map(({ program }) => program));
  for (const { text, program } of asked.filter((each) => each.program.state === "failed")) {
    errors.push(...complaintsOf(text, program, engine.shared, texts));
    programs.release(program);
  }
  const changed = [...new Set(asked.map(({ text }) => text))];
  return { errors: distinct(errors), programs: programs.compiled - compiled, kernels: changed };
};

/** Return what a driver says of a program, at the lines of its files, in plain words.
 *  @param {KernelText} text @param {import("./programs.js").Program} program
 *  @param {import("./schema.js").Shared} shared @param {Object<string, string>} texts edited files
 *  @returns {Complaint[]} */
export const complaintsOf = (text, program, shared, texts) => {
  const { first } = stagesOf(text, new Map(), ""), { kernel, flat } = text;
  const about = {
    lines: flat.lines, file: kernel.file, kernel: kernel.name, library: libraryOf(shared.files),
    text: (/** @type {string} */ file) => texts[file] ?? shared.files[file],
  };
  const logs = program.logs.flatMap((log, stage) => (log.trim() ? [{ log, first: first[stage] }] : []));
  if (!logs.length) logs.push({ log: program.link, first: first[1] });
  return logs.flatMap(({ log, first: line }) => complaints(log, { ...about, first: line }))
    .filter(({ severity }) => severity === "error");
};

/** @param {Complaint[]} found */
const distinct = (found) => {
  const known = new Set();
  return found.filter(({ file, line, message }) => {
    const key = `${file}:${line}:${message}`, isNew = !known.has(key);
    known.add(key);
    return isNew;
  });
};
