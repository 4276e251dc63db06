// wrap.js -- makes the text of a shader stage from a kernel's flat text: shader/stage_recipe.py.

/** @typedef {import("./schema.js").Stage} Stage */
/** @typedef {import("./source.js").Flat} Flat */

const VERSION = /^\s*#\s*version\b/;

/** The text of a stage, in desktop GLSL, and the line of it, from 1, of the first of the kernel's lines;
 *  0: it is made of none.
 *  @param {Stage} stage @param {Flat} flat @returns {{text: string, first: number}} */
export function stageText(stage, flat) {
  if (stage.text !== undefined) return { text: stage.text, first: 0 };
  const before = (stage.before ?? [])
    .filter(({ names }) => !names || names.some((name) => flat.names.has(name)))
    .map(({ text }) => `${text}\n`).join("");
  const after = stage.after ? `${stage.after}\n` : "";
  return { text: before + linesOf(stage, flat) + after, first: before.split("\n").length };
}

/** The kernel's lines as a stage has them.
 *  @param {Stage} stage @param {Flat} flat */
function linesOf(stage, flat) {
  const codes = flat.lines.map(({ code }) => code);
  if (stage.keepsVersion) {
    // Some drivers do not count blank lines above #version.
    const above = Math.max(codes.findIndex((code) => code.trim()), 0);
    return `${codes.fill("//", 0, above).join("\n")}\n`;
  }
  const version = codes.findIndex((code) => VERSION.test(code));
  if (version >= 0) codes[version] = "";
  let code = `${codes.join("\n")}\n`;
  if (stage.without) code = withoutFunction(code, stage.without);
  for (const [name, instead] of Object.entries(stage.replace ?? {})) {
    code = code.replace(new RegExp(`\\b${name}\\b`, "g"), instead);
  }
  return code;
}

/** Blanks a function's definition, not its line ends: what one stage calls may be missing in the other.
 *  @param {string} code @param {string} name */
function withoutFunction(code, name) {
  const match = new RegExp(`\\b\\w+\\s+${name}\\s*\\([^)]*\\)\\s*\\{`).exec(code);
  if (!match) return code;
  let end = match.index + match[0].length;
  for (let depth = 1; depth && end < code.length; end++) {
    depth += code[end] === "{" ? 1 : code[end] === "}" ? -1 : 0;
  }
  return code.slice(0, match.index) + code.slice(match.index, end).replace(/[^\n]/g, " ") + code.slice(end);
}
