// sketch_files.js -- the texts that a sketch is made of: its own first, then kernels, then what they include.

/** @import { Shared, Sketch } from "./schema.js" */

// ── What an edit changes that Python reads, and so has no effect in the page.

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

// ── The texts that a sketch is made of

/** @typedef {{key: "ownFiles" | "kernelFiles" | "libraryFiles", files: string[]}} FileGroup */

/** Every file that a file includes, itself first, each once.
 *  @param {Pick<Shared, "includes">} shared @param {string} file
 *  @returns {string[]} */
function includedBy(shared, file) {
  const found = new Set([file]);
  for (const one of found) for (const next of Object.values(shared.includes[one] ?? {})) found.add(next);
  return [...found];
}

/** The leaves of nodes, those in loops as well.
 *  @param {import("./schema.js").Node[]} nodes @returns {import("./schema.js").Leaf[]} */
const leavesOf = (nodes) => nodes.flatMap((node) => ("loop" in node ? leavesOf(node.body) : [node]));

/** The files of a sketch in groups, in the order of its passes; none is empty.
 *  @param {Pick<Sketch, "kernels" | "nodes">} sketch @param {Pick<Shared, "files" | "includes">} shared
 *  @returns {FileGroup[]} */
export function fileGroups(sketch, shared) {
  const there = (/** @type {string[]} */ files) =>
    [...new Set(files)].filter((file) => isShader(shared, file));
  const kernels = there(leavesOf(sketch.nodes).map(({ kernel }) => sketch.kernels[kernel].file));
  const all = there(kernels.flatMap((file) => includedBy(shared, file)));
  const own = all.filter((file) => file.startsWith("./") || file.startsWith("sketches/"));
  /** @type {FileGroup[]} */
  const groups = [
    { key: "ownFiles", files: own },
    { key: "kernelFiles", files: kernels.filter((file) => !own.includes(file)) },
    { key: "libraryFiles", files: all.filter((file) => ![...own, ...kernels].includes(file)).sort() },
  ];
  return groups.filter(({ files }) => files.length);
}

/** @param {Pick<Shared, "files">} shared @param {string} file */
const isShader = (shared, file) => shared.files[file] !== undefined && !file.endsWith(".toml");
