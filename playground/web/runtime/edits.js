// edits.js -- tries an edited text: all kernels that it is part of are compiled, and what is wrong is told
// by line.

import { readKernel, stagesOf } from "./kernel_texts.js";

/** @typedef {{file: string, line: number, message: string, kernel: string}} Complaint  line 0: of no line */
/** @typedef {{errors: Complaint[], programs: number}} Edit  programs: how many were compiled */
/** @typedef {import("./kernel_texts.js").KernelText} KernelText */
/** @typedef {import("./schema.js").Kernel} Kernel */

const ERROR = /^ERROR: \d+:(\d+): (.*)$/gm; // as browsers write it, whatever the driver

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
    errors.push(...complaintsOf(text, program));
    programs.release(program);
  }
  const changed = [...new Set(asked.map(({ text }) => text))];
  return { errors: distinct(errors), programs: programs.compiled - compiled, kernels: changed };
};

/** Return what a driver says of a program, at the lines of its files.
 *  @param {KernelText} text @param {import("./programs.js").Program} program @returns {Complaint[]} */
export const complaintsOf = (text, program) => {
  const { first } = stagesOf(text, new Map(), ""), { lines } = text.flat, { name, file } = text.kernel;
  const found = program.logs.flatMap((log, stage) => [...log.matchAll(ERROR)].map(([, number, message]) => {
    const line = first[stage] ? lines[+number - first[stage]] : undefined;
    return { file: line ? line.file : file, line: line ? line.line : 0, message, kernel: name };
  }));
  const rest = [...program.logs, program.link].join("\n").trim();
  const message = rest || "The driver refused it without a word.";
  return found.length ? found : [{ file, line: 0, message, kernel: name }];
};

/** @param {Complaint[]} complaints */
const distinct = (complaints) => {
  const known = new Set();
  return complaints.filter(({ file, line, message }) => {
    const key = `${file}:${line}:${message}`, isNew = !known.has(key);
    known.add(key);
    return isNew;
  });
};
