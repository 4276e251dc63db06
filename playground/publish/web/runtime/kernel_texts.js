// kernel_texts.js -- what a kernel's text says: names it reads, what it is known by, the texts of its stages.

import { hash } from "./hash.js";
import { usedBy } from "./staleness.js";
import { flatten } from "./source.js";
import { stageText } from "./wrap.js";
import { toES } from "./es.js";
import { declaredUniforms } from "./uniforms.js";
import { filteredByHand } from "./linear_by_hand.js";

/** @typedef {import("./schema.js").Kernel} Kernel */
/** @typedef {import("./schema.js").Shared} Shared */

/** @typedef {object} KernelText
 *  @property {Kernel} kernel
 *  @property {import("./source.js").Flat} flat
 *  @property {import("./source.js").Flat} vertex   its author's own vertex shader's, else the same
 *  @property {string[]} given         names that the engine gives it
 *  @property {Set<string>} used       names in its text besides their declaration, or in its header
 *  @property {string} identity        the same for the same header and text
 *  @property {Map<string, import("./programs.js").Program>} programs   by how samplers are filtered
 *  @property {Map<string, Map<string, import("./linear_by_hand.js").Wrap>>} hands   those ways
 *  @property {[string, any][]} own    uniforms with a value in the text that its header does not know */

/** Read a kernel; throws where a file is missing, with `file` and `line`.
 *  @param {Shared} shared @param {Kernel} kernel @param {Object<string, string>} texts edited files
 *  @returns {KernelText} */
export const readKernel = (shared, kernel, texts) => {
  const source = kernel.kind === "source";
  const flat = source ? { lines: [], names: new Set() }
    : flatten(shared, kernel.file, texts, { once: !!kernel.dialect });
  const once = { once: !!kernel.dialect }, own = kernel.vertex?.file;
  const vertex = own ? flatten(shared, own, texts, once) : flat;
  const code = (own ? [...flat.lines, ...vertex.lines] : flat.lines).map((line) => line.code).join("\n");
  const given = Object.keys(shared.given).filter((name) => flat.names.has(name));
  const declared = new Set(kernel.parameters.map(({ name }) => name));
  return {
    kernel, flat, vertex, given, programs: new Map(), hands: new Map(),
    used: usedBy(kernel, code, given),
    identity: hash(JSON.stringify([kernel, code])),
    own: declaredUniforms(flat.lines).filter(({ name, value }) => value !== null && !declared.has(name))
      .map(({ name, value }) => [name, value]),
  };
};

/** Return the texts of a kernel's stages in GLSL ES, and the first line of its own in each.
 *  @param {KernelText} read
 *  @param {Map<string, import("./linear_by_hand.js").Wrap>} byHand samplers that are filtered in the text
 *  @param {string} atEnd of the fragment shader's main function
 *  @returns {{texts: [string, string], first: [number, number]}} */
export const stagesOf = ({ kernel, flat, vertex }, byHand, atEnd) => {
  const stages = [kernel.vertex, kernel.fragment].map((stage, i) => {
    const { text, first } = stageText(stage, i ? flat : vertex);
    const filtered = byHand.size ? filteredByHand(text, byHand) : { text, functions: "" };
    const found = i && atEnd ? filtered.text.replace(/\}\s*$/, `${atEnd} }\n`) : filtered.text;
    const how = { extensions: kernel.extensions, declarations: filtered.functions };
    return { text: toES(found, how), first };
  });
  return { texts: [stages[0].text, stages[1].text], first: [stages[0].first, stages[1].first] };
};
