// plan_nodes.js -- the steps and loops of a plan: what they are, and how to go through them.

/** @import { Source, Value } from "./schema.js" */

/** @typedef {{path: string, output: string}} Ref */

/** A leaf pass made concrete.
 *  @typedef {object} Step
 *  @property {string} path
 *  @property {import("./schema.js").Kernel} kernel
 *  @property {import("./schema.js").Leaf | null} leaf   null: of a map
 *  @property {Object<string, Value>} values             what uniforms get, by parameter; of a file its key
 *  @property {[string, Source | null][]} inputs
 *  @property {[number, number]} size                    texels
 *  @property {number} repeat                            iterations to run
 *  @property {number} total                             iterations in all
 *  @property {{k_stride: number, k_form: number} | null} between   see betweenOf of formulas.js */

/** A loop made concrete. bodies: of each iteration, one where all are the same; body: of the last.
 *  @typedef {{path: string, loop: true, repeat: number, total: number, countsFrames: boolean,
 *             followsTime: boolean, bodies: PlanNode[][], body: PlanNode[],
 *             feedback: [string, Source | null, Ref][]}} LoopStep */

/** @typedef {Step | LoopStep} PlanNode */

/** @param {PlanNode} node @returns {node is LoopStep} */
export const isLoop = (node) => "loop" in node;

/** @param {Source | null} source @returns {source is Ref} */
export const isRef = (source) => source !== null && "path" in source;

/** What an iteration of a loop runs: nodes of the same paths in each, of other sizes and counts.
 *  @param {LoopStep} loop @param {number} iteration */
export const bodyOf = ({ bodies }, iteration) => bodies[bodies.length > 1 ? iteration : 0];

/** Every step and loop, of a loop those of each iteration that has its own.
 *  @param {PlanNode[]} nodes @returns {PlanNode[]} */
export const everyVersion = (nodes) => nodes.flatMap((node) => {
  return isLoop(node) ? [node, ...[...new Set(node.bodies)].flatMap(everyVersion)] : [node];
});

/** Every step, those of loops' last iterations included.
 *  @param {PlanNode[]} nodes @returns {Step[]} */
export const stepsOf = (nodes) => nodes.flatMap((node) => (isLoop(node) ? stepsOf(node.body) : [node]));

/** What a node reads, what the passes of a loop read from each other included.
 *  @param {PlanNode} node @returns {Source[]} */
export function sourcesOf(node) {
  const all = isLoop(node) ? node.feedback : node.inputs;
  const found = all.map(([, source]) => source).filter((source) => source !== null);
  return isLoop(node) ? [...found, ...node.body.flatMap(sourcesOf)] : found;
}

/** The nodes that a texture depends on, in order.
 *  @param {PlanNode[]} nodes @param {Ref} ref @returns {PlanNode[]} */
export function needed(nodes, ref) {
  const wanted = new Set([ref.path]);
  return [...nodes].reverse().filter((node) => {
    if (!stepsOf([node]).some((step) => wanted.has(step.path))) return false;
    for (const source of sourcesOf(node)) if (isRef(source)) wanted.add(source.path);
    return true;
  }).reverse();
}

/** Return which outputs are read with levels, as "path:output". @param {PlanNode[]} nodes */
export const readWithLevels = (nodes) => {
  /** @type {Set<string>} */
  const found = new Set();
  /** @type {Map<string, [Source | null, Source]>} */
  const fed = new Map();
  /** @param {Source | null} source */
  const add = (source) => {
    if (!source) return;
    if ("path" in source) found.add(`${source.path}:${source.output}`);
    else fed.get(`${source.loop} ${source.name}`)?.forEach(add);
  };
  /** @param {PlanNode} node */
  const look = (node) => {
    if (isLoop(node)) {
      for (const [name, first, ref] of node.feedback) fed.set(`${node.path} ${name}`, [first, ref]);
      node.body.forEach(look);
      return;
    }
    const tall = node.kernel.inputs.filter(({ sampling }) => sampling.mipmap).map(({ name }) => name);
    if (tall.length) for (const [name, source] of node.inputs) if (tall.includes(name)) add(source);
  };
  nodes.forEach(look);
  return found;
};
