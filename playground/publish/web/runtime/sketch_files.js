// sketch_files.js -- the texts that a sketch is made of: its own first, then kernels, then what they include.

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./schema.js").Shared} Shared */
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
