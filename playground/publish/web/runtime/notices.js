// notices.js -- what an edit changes that Python reads, and so has no effect in the page.

/** @typedef {{key: "header" | "annotation" | "initial" | "added" | "removed", names: string[]}} Notice */

const PRAGMA = /^[ \t]*#[ \t]*pragma[ \t]+(?:kernel|source|draw|compute)\b(?:.*\\\n)*.*/gm;
const ANNOTATION = /\/\/!.*/g;
const UNIFORM = /^[ \t]*uniform\s+(?:(?:low|medium|high)p\s+)?(\w+)\s+([^;]*);/gm;

/** Compare a text with the file's own.
 *  @param {string} original @param {string} text
 *  @returns {Notice[]} */
export function notices(original, text) {
  /** @type {Notice[]} */
  const found = [];
  const differs = (/** @type {RegExp} */ of) => said(original, of) !== said(text, of);
  const before = uniforms(original), now = uniforms(text);
  const names = (/** @type {(name: string) => boolean} */ holds) =>
    [...new Set([...now.keys(), ...before.keys()])].filter(holds);
  const added = names((name) => now.has(name) && !before.has(name));
  const removed = names((name) => !now.has(name) && before.has(name));
  const initial = names((name) => now.has(name) && before.has(name) && now.get(name) !== before.get(name));
  if (differs(PRAGMA)) found.push({ key: "header", names: [] });
  if (added.length) found.push({ key: "added", names: added });
  if (removed.length) found.push({ key: "removed", names: removed });
  if (initial.length) found.push({ key: "initial", names: initial });
  if (!added.length && !removed.length && differs(ANNOTATION)) found.push({ key: "annotation", names: [] });
  return found;
}

/** @param {string} text @param {RegExp} of */
const said = (text, of) =>
  [...text.matchAll(of)].map(([one]) => one.replace(/\\\n|\s+/g, " ").replace(/ +/g, " ").trim()).join("\n");

/** @param {string} text @returns {Map<string, string>} name → how it is declared */
function uniforms(text) {
  /** @type {Map<string, string>} */
  const found = new Map();
  const code = text.replace(/\/\/.*|\/\*[^]*?\*\//g, "");
  for (const [, type, names] of code.matchAll(UNIFORM)) {
    if (/sampler|image/.test(type)) continue;
    for (const one of names.split(/,(?![^(]*\))/)) {
      const [, name, value] = /^\s*(\w+)[^=]*(?:=([^]*))?$/.exec(one) || [];
      if (name) found.set(name, `${type} ${(value || "").replace(/\s+/g, "")}`);
    }
  }
  return found;
}
