// chosen.js -- programs with what is chosen written in, where a program draws: engine/kernels.py.
//
// A software renderer goes both ways of every `if`: what was not chosen costs as much as what was, unless
// its compiler can see that it never happens. A kernel that is drawn again and again with the same
// checkboxes, menus and wires gets a program of its own for them, compiled behind the one that is drawn.

import { isSize } from "./binder.js";

/** @typedef {import("./programs.js").Program} Program */
/** @typedef {import("./kernels.js").Job} Job */

const OFTEN = 3; // draws with the same choices, after which they are written in
const MAX_PROGRAMS = 8; // programs with choices that are remembered of one without

/** Write checkboxes, menus and what is wired into a stage's text as constants: no line and no column moves.
 *  @param {string} text @param {[string, number][]} choices names, whole numbers @returns {string} */
export const withChoices = (text, choices) => {
  for (const [name, value] of choices) {
    const pattern = new RegExp(`^([ \\t]*)uniform([ \\t]+(bool|int)[ \\t]+${name}\\b)[^;\\n]*;`, "gm");
    text = text.replace(pattern, (_, before, declared, type) =>
      `${before}const  ${declared} = ${type === "bool" ? Boolean(value) : value};`);
  }
  return text;
};

/** What is chosen of a step, and what of it is wired. @param {Job} job @returns {[string, number][]} */
const choicesOf = ({ step, inputs }) => {
  const { kernel, values, size } = step;
  /** @type {[string, number][]} */
  const found = [];
  for (const { name, type, widget } of kernel.parameters) {
    if ((type === "bool" && widget !== "button") || (type === "int" && widget === "menu"))
      found.push([name, Number(values[name])]);
  }
  let unwired = false;
  for (const { name, fallback } of kernel.inputs) {
    const wired = inputs.get(name);
    unwired ||= !wired && !!fallback;
    found.push([`wired_${name}`, Number(!!wired)]);
    found.push([`matches_${name}`, Number(!!wired && isSize(wired.texture.size, size))]);
  }
  return [...found, ["k_unwired", Number(unwired)]];
};

/** @param {import("./context.js").Context} context @param {import("./programs.js").Programs} programs
 *  @param {number} [often]  draws with the same choices until they are written in */
export const createChosen = ({ software, parallel }, programs, often = OFTEN) => {
  /** The program to draw a step with: the one that is given, until another is ready.
   *  @param {Job} job @param {Program} general @returns {Program} */
  const of = (job, general) => {
    if (!software || !parallel || job.step.kernel.kind === "plain_fragment") return general;
    const choices = choicesOf(job), key = choices.join(), { chosen } = general;
    const found = chosen.get(key) ?? { times: 0, program: null };
    chosen.delete(key);
    chosen.set(key, found);
    if (chosen.size > MAX_PROGRAMS) chosen.delete(/** @type {string} */ (chosen.keys().next().value));
    if (found.program?.state === "gone") found.program = null;
    if (!found.program && ++found.times < often) return general;
    found.program ??= programs.ask(texts(general, choices));
    programs.touch(found.program);
    return programs.isDone(found.program) && programs.finish(found.program) ? found.program : general;
  };

  return { of };
};

/** @param {Program} general @param {[string, number][]} choices @returns {[string, string]} */
const texts = ({ texts: [vertex, fragment] }, choices) =>
  [withChoices(vertex, choices), withChoices(fragment, choices)];
