// edits.js -- tries an edited text: all kernels that it is part of are compiled, and what is wrong is told
// by line.

import { complaints } from "./complaints.js";
import { readKernel, stagesOf } from "./kernel_texts.js";
import { libraryOf } from "./name_suggestions.js";
import { checkSignature } from "./signature.js";

/** @typedef {{file: string, line: number, column?: number, message: string, kernel: string}} Complaint
 *  line 0: of no line */
/** @typedef {{errors: Complaint[], programs: number}} Edit  programs: how many were compiled */
/** @typedef {import("./kernel_texts.js").KernelText} KernelText */
/** @typedef {import("./schema.js").Kernel} Kernel */

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
