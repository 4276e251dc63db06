// written_parameters.js -- gives a sketch the parameters of a text that is edited in the page: a uniform that
// is typed has a row, and one that is taken out has none.

import { writtenParameters } from "./annotations.js";
import { flatten } from "./source.js";
import { declaredUniforms } from "./uniforms.js";
import { leavesOf } from "./values.js";

/** @typedef {import("./schema.js").Kernel} Kernel */
/** @typedef {import("./schema.js").Leaf} Leaf */
/** @typedef {import("./schema.js").Node} Node */
/** @typedef {import("./schema.js").Shown} Shown */
/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./annotations.js").Written} Written */

/** What a text says of a kernel: its own parameters, and all names that are declared with those of includes.
 *  @typedef {{written: Written[], names: Set<string>}} Said */
/** By kernel; a kernel that does not read the file is not there. @typedef {Map<Kernel, Said>} Read */

/** Follow a file of a sketch, which is changed in place.
 *  @param {Sketch} sketch @param {import("./schema.js").Shared} shared @param {string} file
 *  @param {string} first  the file's text that the sketch's rows and values are of */
export function followParameters(sketch, shared, file, first) {
  const { kernels, nodes, values, shown } = sketch, before = readAll(first);
  let known = "";

  /** @param {string} text @returns {Read} */
  function readAll(text) {
    /** @type {Read} */
    const found = new Map();
    for (const kernel of kernels) {
      if (kernel.kind === "source" || kernel.kind === "plain_fragment") continue;
      const { lines } = flatten(shared, kernel.file, { [file]: text });
      if (!lines.some((line) => line.file === file)) continue;
      const names = new Set(declaredUniforms(lines).map(({ name }) => name));
      found.set(kernel, { written: writtenParameters(lines, file), names });
    }
    return found;
  }

  /** @param {Kernel} kernel @param {Said} said @returns {Kernel} */
  function kernelWith(kernel, { written, names }) {
    const own = new Set(written.map(({ uniform }) => uniform.name));
    const others = kernel.parameters.filter(({ name }) => names.has(name) && !own.has(name));
    return { ...kernel, parameters: [...others, ...written.map(({ uniform }) => uniform)] };
  }

  /** @param {Leaf} leaf @param {string} name */
  const pathOf = (leaf, name) => leaf.values[name] ?? `${leaf.path}.${name}`;

  /** @param {Node} node @param {Read} read @returns {Node} */
  function nodeWith(node, read) {
    if ("loop" in node) return { ...node, body: node.body.map((inside) => nodeWith(inside, read)) };
    const said = read.get(kernels[node.kernel]);
    if (!said) return node;
    const own = said.written.map(({ uniform: { name } }) => [name, pathOf(node, name)]);
    return { ...node, values: { ...node.values, ...Object.fromEntries(own) } };
  }

  /** A parameter has the value that its text says, unless the sketch sets another.
   *  @param {Leaf} leaf @param {Written} one */
  function valueOf(leaf, { uniform: { name }, facts }) {
    const set = values[pathOf(leaf, name)];
    const was = before.get(kernels[leaf.kernel])?.written.find(({ uniform }) => uniform.name === name);
    return set === undefined || JSON.stringify(set) === JSON.stringify(was?.facts.value) ? facts.value : set;
  }

  return {
    /** Read a text; throws an error with `file` and `line` for what cannot be read. @param {string} text */
    read: readAll,
    /** Give the sketch what a text says; returns whether its rows are others than before.
     *  @param {Read} read */
    take(read) {
      const rows = shown.map((row) => ({ ...row }));
      const now = { ...values };
      for (const leaf of leavesOf(nodes)) {
        const said = read.get(kernels[leaf.kernel]);
        if (!said) continue;
        for (const [name, path] of Object.entries(leaf.values)) {
          const at = rows.findIndex(({ targets }) => targets.length === 1 && targets[0] === path);
          if (!said.names.has(name) && at >= 0) rows.splice(at, 1);
        }
        for (const one of said.written) {
          const path = pathOf(leaf, one.uniform.name), value = valueOf(leaf, one);
          now[path] = value;
          const at = rows.findIndex((row) => row.path === path);
          const row = { ...one.facts, value, path, targets: [path] };
          const pass = path.split(".")[0], exported = leaf.path === pass;
          if (at >= 0) rows[at] = { ...rows[at], ...row };
          else rows.push({ ...row, pass, exported, main: 0, locked: "" });
        }
      }
      const text = JSON.stringify([rows, [...read.values()].map(({ written, names }) => [
        [...names], written.map(({ uniform }) => uniform),
      ])]);
      if (text === known) return false;
      known = text;
      sketch.kernels = kernels.map((kernel) => {
        const said = read.get(kernel);
        return said ? kernelWith(kernel, said) : kernel;
      });
      sketch.nodes = nodes.map((node) => nodeWith(node, read));
      sketch.values = now;
      sketch.shown = rows;
      return true;
    },
    /** The rows that the first text has none of, by path. */
    get added() {
      const old = new Set(shown.map(({ path }) => path));
      return sketch.shown.flatMap(({ path }) => (old.has(path) ? [] : [path]));
    },
  };
}
