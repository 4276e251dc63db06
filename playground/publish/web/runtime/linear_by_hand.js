// linear_by_hand.js -- filters textures of 32-bit floats in the shader, where the device does not.
//
// Phones lack OES_texture_float_linear: there such a texture reads as zeros wherever it is to be filtered.
// In a
// program's text each texture(NAME, place) and its like becomes a function that mixes four texels, for
// samplers
// NAME that read such a texture and for the parameters of functions that they are handed to.

/** @typedef {"clamp" | "repeat" | "mirror"} Wrap */

const ROUND = "(k_i % (2 * k_n) + 2 * k_n) % (2 * k_n)";
const MOVED = {
  clamp: "clamp(k_i, ivec2(0), k_n - 1)",
  repeat: "(k_i % k_n + k_n) % k_n",
  mirror: `min(${ROUND}, 2 * k_n - 1 - ${ROUND})`,
};

/** @param {Wrap} wrap */
const functions = (wrap) => {
  const name = `k_linear_${wrap}`, call = `{ return ${name}(k_s, k_p); }`;
  const texel = `vec4 ${name}(sampler2D k_s, ivec2 k_i) { ivec2 k_n = textureSize(k_s, 0);`
    + ` return texelFetch(k_s, ${MOVED[wrap]}, 0); }`;
  const mixed = `vec4 ${name}(sampler2D k_s, vec2 k_p) { vec2 k_q = k_p * vec2(textureSize(k_s, 0)) - 0.5;`
    + " ivec2 k_i = ivec2(floor(k_q)); vec2 k_f = k_q - floor(k_q); return mix("
    + `mix(${name}(k_s, k_i), ${name}(k_s, k_i + ivec2(1, 0)), k_f.x),`
    + ` mix(${name}(k_s, k_i + ivec2(0, 1)), ${name}(k_s, k_i + 1), k_f.x), k_f.y); }`;
  return `${texel} ${mixed} vec4 ${name}(sampler2D k_s, vec2 k_p, float k_l) ${call}`
    + ` vec4 ${name}(sampler2D k_s, vec2 k_p, vec2 k_x, vec2 k_y) ${call} `;
};

/** Return a stage's text in which some samplers are filtered by hand, and the functions that it calls for
 *  that,
 *  on one line; the text keeps its lines.
 *  @param {string} text without comments @param {Map<string, Wrap>} samplers */
export const filteredByHand = (text, samplers) => {
  const names = reached(text, samplers), list = [...names.keys()].join("|");
  const calls = new RegExp(`\\btexture(?:Lod|Grad)?\\s*\\(\\s*(${list})\\b(?=\\s*,)`, "g");
  const changed = text.replace(calls, (_, name) => `k_linear_${names.get(name)}(${name}`);
  const wraps = changed === text ? [] : [...new Set(names.values())];
  return { text: changed, functions: wraps.map(functions).join("") };
};

/** Return the samplers and the functions' parameters that they reach.
 *  @param {string} text @param {Map<string, Wrap>} samplers @returns {Map<string, Wrap>} */
const reached = (text, samplers) => {
  const found = new Map(samplers);
  const taking = [...text.matchAll(/\b(\w+)\s*\(([^()]*\bsampler2D\b[^()]*)\)\s*\{/g)].map((match) =>
    ({ name: match[1], parameters: match[2].split(",").map((each) => each.trim().replace(/.*\s/, "")) }));
  for (let before = -1; before !== found.size;) {
    before = found.size;
    for (const { name, parameters } of taking) {
      for (const given of callsOf(text, name)) given.forEach((argument, i) => {
        const wrap = found.get(argument);
        if (wrap && parameters[i] && !found.has(parameters[i])) found.set(parameters[i], wrap);
      });
    }
  }
  return found;
};

/** Return the arguments of each call of a function.
 *  @param {string} text @param {string} name @returns {string[][]} */
const callsOf = (text, name) => [...text.matchAll(new RegExp(`\\b${name}\\s*\\(`, "g"))].map((match) => {
  const found = [""];
  for (let at = match.index + match[0].length, depth = 1; at < text.length; at++) {
    const mark = text[at];
    depth += mark === "(" ? 1 : mark === ")" ? -1 : 0;
    if (!depth) break;
    if (mark === "," && depth === 1) found.push("");
    else found[found.length - 1] += mark;
  }
  return found.map((each) => each.trim());
});
