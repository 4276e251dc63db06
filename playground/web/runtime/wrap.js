// wrap.js -- makes the text of a shader stage from a kernel's flat text: gpu/wrap.py, which is data here.

/** @typedef {import("./schema.js").Stage} Stage */
/** @typedef {import("./source.js").Flat} Flat */

/** The text of a stage, in desktop GLSL, and the line of it, from 1, of the kernel's first line; 0: it has none.
 *  @param {Stage} stage @param {Flat} flat @returns {{text: string, first: number}} */
export function stageText(stage, flat) {
  if (stage.text !== undefined) return { text: stage.text, first: 0 };
  const before = (stage.before ?? [])
    .filter(({ names }) => !names || names.some((name) => flat.names.has(name)))
    .map(({ text }) => `${text}\n`).join("");
  let code = flat.lines.map((line) => `${line.code}\n`).join("");
  if (stage.without) code = without(code, stage.without);
  for (const [name, instead] of Object.entries(stage.replace ?? {})) {
    code = code.replace(new RegExp(`\\b${name}\\b`, "g"), instead);
  }
  const after = stage.after ? `${stage.after}\n` : "";
  return { text: before + code + after, first: before.split("\n").length };
}

/** Blanks a function's definition, not its line ends: what one stage calls may be missing in the other.
 *  @param {string} code @param {string} name */
function without(code, name) {
  const match = new RegExp(`\\b\\w+\\s+${name}\\s*\\([^)]*\\)\\s*\\{`).exec(code);
  if (!match) return code;
  let end = match.index + match[0].length;
  for (let depth = 1; depth && end < code.length; end++) {
    depth += code[end] === "{" ? 1 : code[end] === "}" ? -1 : 0;
  }
  return code.slice(0, match.index) + code.slice(match.index, end).replace(/[^\n]/g, " ") + code.slice(end);
}
