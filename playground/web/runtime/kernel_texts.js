// kernel_texts.js -- what a kernel's text says: names it reads, what it is known by, the texts of its stages.

import { flatten } from "./source.js";
import { stageText } from "./wrap.js";
import { toES } from "./es.js";
import { filteredByHand } from "./linear_by_hand.js";

/** @typedef {import("./schema.js").Kernel} Kernel */
/** @typedef {import("./schema.js").Shared} Shared */

/** @typedef {object} KernelText
 *  @property {Kernel} kernel
 *  @property {import("./source.js").Flat} flat
 *  @property {string[]} given         names that the engine gives it
 *  @property {Set<string>} used       names in its text besides their declaration, or in its header
 *  @property {string} identity        the same for the same header and text
 *  @property {Map<string, import("./programs.js").Program>} programs   by how samplers are filtered
 *  @property {[string, any][]} own    uniforms with a value in the text that its header does not know */

/** @type {Map<string, string>} */
const identities = new Map();

/** Read a kernel; throws where a file is missing, with `file` and `line`.
 *  @param {Shared} shared @param {Kernel} kernel @param {Object<string, string>} texts edited files
 *  @returns {KernelText} */
export const readKernel = (shared, kernel, texts) => {
  const source = kernel.kind === "source";
  const flat = source ? { lines: [], names: new Set() }
    : flatten(shared, kernel.file, texts, { once: !!kernel.dialect });
  const code = flat.lines.map((line) => line.code).join("\n");
  /** @type {Map<string, number>} */
  const times = new Map();
  for (const [name] of code.matchAll(/[A-Za-z_]\w*/g)) times.set(name, (times.get(name) || 0) + 1);
  const used = new Set(kernel.used || []);
  times.forEach((many, name) => many > 1 && used.add(name));
  if (times.has("iterations")) used.add("iterations");
  const declared = new Set(kernel.parameters.map(({ name }) => name));
  for (const name of declared) if (source || times.has(`towards_${name}`) || (kernel.dialect && times.has(name))) used.add(name);
  const whole = JSON.stringify([kernel, code]);
  if (!identities.has(whole)) identities.set(whole, `${kernel.name}#${identities.size}`);
  return {
    kernel, flat, used, programs: new Map(),
    given: Object.keys(shared.given).filter((name) => flat.names.has(name)),
    identity: /** @type {string} */ (identities.get(whole)),
    own: [...code.matchAll(/^[ \t]*uniform\s+(\w+)\s+(\w+)\s*=([^;\n]*);/gm)].filter((match) => !declared.has(match[2]))
      .map(([, , name, value]) => [name, literal(value)]),
  };
};

/** Return the value of an initialiser: numbers, in a constructor or alone. @param {string} text */
const literal = (text) => {
  const numbers = (text.replace(/\b[iub]?vec[234]/g, "").match(/[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?|true|false/g) || [])
    .map((each) => (each === "true" ? 1 : each === "false" ? 0 : Number(each)));
  const [, many] = /\bvec([234])|[iub]vec([234])/.exec(text) || [];
  return many && numbers.length === 1 ? Array(+many).fill(numbers[0]) : numbers.length === 1 ? numbers[0] : numbers;
};

/** Return the texts of a kernel's stages in GLSL ES, and the first line of its own in each.
 *  @param {KernelText} read
 *  @param {Map<string, import("./linear_by_hand.js").Wrap>} byHand samplers that are filtered in the text
 *  @param {string} atEnd of the fragment shader's main function
 *  @returns {{texts: [string, string], first: [number, number]}} */
export const stagesOf = ({ kernel, flat }, byHand, atEnd) => {
  const stages = [kernel.vertex, kernel.fragment].map((stage, i) => {
    const { text, first } = stageText(stage, flat);
    const es = toES(text, { extensions: kernel.extensions });
    const hand = byHand.size ? filteredByHand(es, byHand) : es;
    return { text: i && atEnd ? hand.replace(/\}\s*$/, `${atEnd} }\n`) : hand, first };
  });
  return { texts: [stages[0].text, stages[1].text], first: [stages[0].first, stages[1].first] };
};
