// staleness.js -- works out what each step's textures depend on: playground/engine/cache_keys.py.
//
// A step is stale where its key changes. The key holds its text, the values and given names that the text
// uses, its size and count of iterations, and the keys of what it reads. Inside a loop, what is fed back has
// a name in place of a key, so that a loop can go on from the iteration that is cached. The time, the mouse
// and all else that belongs to a frame are in no key where a loop counts frames: they are its iterations'.

import { everyVersion, isLoop, isRef, sourcesOf, stepsOf } from "./plan_nodes.js";

/** @import { LoopStep, PlanNode, Step } from "./plan_nodes.js"
 *  @import { Kernel, Source } from "./schema.js" */

/** What an engine knows of steps and kernels.
 *  @typedef {object} Known
 *  @property {(step: Step) => Object<string, any>} given  what the engine gives a step besides its
 *      parameters, of a draw with its samples: by name; a pressed button as "pressed NAME"
 *  @property {(kernel: Kernel) => Set<string>} used       see `usedBy`
 *  @property {(kernel: Kernel) => string} text            what tells its text and header from others */

/** Keys of one plan. `steps` and `loops` by path; `raw` the same of what a step has where more is shown;
 *  `unfinished` after any number of iterations; `changes`: the paths of the loops around a node whose
 *  iterations change it.
 *  @typedef {{steps: Map<string, string>, raw: Map<string, string>, unfinished: Map<string, string>,
 *             loops: Map<string, string>, changes: Map<PlanNode, Set<string>>}} Keys */

/** The loops around a node, by their paths: the innermost, and the innermost that counts frames.
 *  @typedef {{innermost: string, frames: string}} Around */

/** What belongs to one frame: see CLOCKED in playground/shader/reserved_names.py. */
const CLOCKED = new Set([
  "time", "frame", "frame_of_time", "delta", "date", "date_from_1", "mouse", "hover", "hover_share", "drag",
  "buttons", "bands", "moment",
]);
const PRESSED = "pressed ";

/** The names that a kernel's textures depend on: in its text besides their declaration, or in its header.
 *  @param {Kernel} kernel @param {string} code its text without comments @param {string[]} given
 *      names that the engine gives (schema.js `Shared.given`) @returns {Set<string>} */
export function usedBy(kernel, code, given) {
  /** @type {Map<string, number>} */
  const times = new Map();
  for (const name of code.match(/[A-Za-z_]\w*/g) ?? []) times.set(name, (times.get(name) ?? 0) + 1);
  const used = new Set(kernel.used ?? []);
  for (const [name, count] of times) if (count > 1) used.add(name);
  for (const name of given) if (times.has(name)) used.add(name);
  for (const { name } of kernel.parameters) {
    // What another tool declares is not in its text; all that a source is given counts.
    const own = kernel.kind === "source" || (kernel.dialect && times.has(name));
    if (own || times.has(`towards_${name}`)) used.add(name);
  }
  return used;
}

/** The keys of a step for what it was last known to read: of the next plan they are the same if that is.
 *  @type {WeakMap<Step, {reads: string, unfinished: string, raw: string, shown: string}>} */
const lastKeys = new WeakMap();

/** Work out the keys of a plan.
 *  @param {{nodes: PlanNode[], continued: Set<string>}} plan @param {Known} known @returns {Keys} */
export function keysOf(plan, known) {
  /** @type {Keys} */
  const keys = {
    steps: new Map(), raw: new Map(), unfinished: new Map(), loops: new Map(), changes: new Map(),
  };
  const { continued } = plan;
  /** Loops that a step changes with, for its next reader.
   *  @type {Map<string, Set<string>>} */
  const varies = new Map();
  /** The loops of whose iterations each has another version of a node. @type {Map<PlanNode, Set<string>>} */
  const sized = new Map();

  /** @param {Source | null} source @param {Map<string, string>} fed @returns {string} */
  const keyOf = (source, fed) => {
    if (!source) return "";
    if (isRef(source)) return `${keys.steps.get(source.path)}:${source.output}`;
    return /** @type {string} */ (fed.get(`${source.loop} ${source.name}`));
  };
  /** @param {Source | null} source @param {Map<string, Set<string>>} varying @returns {Iterable<string>} */
  const variesOf = (source, varying) => {
    if (!source) return [];
    return (isRef(source) ? varies.get(source.path) : varying.get(`${source.loop} ${source.name}`)) ?? [];
  };

  /** Add a node with the loops around it; `fed` names what they feed back, `varying` what that changes with.
   *  @param {PlanNode} node @param {Around} around @param {Map<string, string>} fed
   *  @param {Map<string, Set<string>>} varying */
  function add(node, around, fed, varying) {
    if (isLoop(node)) addLoop(node, around, fed, varying);
    else addStep(node, around, fed, varying);
  }

  /** @param {Step} step @param {Around} around @param {Map<string, string>} fed
   *  @param {Map<string, Set<string>>} varying */
  function addStep(step, around, fed, varying) {
    const { kernel, path } = step, used = known.used(kernel);
    const sources = step.inputs.map(([name, source]) => [name, keyOf(source, fed)]);
    const all = known.given(step), counts = kernel.countsFrames;
    const clocked = around.frames || counts ? clockedOf(kernel, all) : new Set();
    const given = Object.entries(all).filter(([name]) => !clocked.has(name));
    const reads = JSON.stringify([known.text(kernel), sources, given, continued.has(path), [...clocked]]);
    let found = lastKeys.get(step);
    if (!found || found.reads !== reads) {
      const values = kernel.parameters.filter((one) => {
        return one.widget === "file" || (used.has(one.name) && !clocked.has(one.name));
      });
      /** @type {any[]} */
      const parts = [reads, step.size, values.map((one) => [one.name, step.values[one.name]])];
      if (used.has("iterations")) parts.push(step.total);
      const raw = hash(JSON.stringify([step.repeat, parts]));
      const { between } = step;
      const shown = between ? hash(JSON.stringify([raw, between])) : raw;
      found = { reads, unfinished: hash(JSON.stringify([path, parts])), raw, shown };
      lastKeys.set(step, found);
    }
    keys.unfinished.set(path, found.unfinished);
    keys.raw.set(path, found.raw);
    keys.steps.set(path, found.shown);
    const fromInputs = step.inputs.flatMap(([, source]) => [...variesOf(source, varying)]);
    const changes = new Set([...fromInputs, ...(sized.get(step) ?? [])]);
    if (around.innermost && kernel.repeat === 1 && used.has("iteration")) changes.add(around.innermost);
    if (around.frames && clocked.size && !counts) changes.add(around.frames);
    varies.set(path, changes);
    keys.changes.set(step, changes);
  }

  /** @param {LoopStep} loop @param {Around} around @param {Map<string, string>} fed
   *  @param {Map<string, Set<string>>} varying */
  function addLoop(loop, around, fed, varying) {
    const { path } = loop, steps = stepsOf(loop.body);
    const inside = [...new Set(steps.map((step) => step.path))].sort(), own = loopsIn(loop);
    const ownSizes = sized.get(loop) ?? new Set();
    const outer = new Set([...ownSizes, ...sourcesOf(loop).flatMap((source) => {
      const within = isRef(source) ? inside.includes(source.path) : own.has(source.loop);
      return within ? [] : [...variesOf(source, varying)];
    })]);
    const names = new Map(fed), changes = new Map(varying);
    for (const [name] of loop.feedback) {
      names.set(`${path} ${name}`, `fed back: ${path} ${name}`);
      changes.set(`${path} ${name}`, new Set([...outer, path]));
    }
    const within = { innermost: path, frames: loop.countsFrames ? path : around.frames };
    noteSized(loop);
    /** The keys of the steps inside, of each body; those of the last iteration's stay. */
    const found = new Map();
    for (const body of new Set([...loop.bodies.filter((one) => one !== loop.body), loop.body])) {
      for (const node of body) add(node, within, names, changes);
      found.set(body, inside.map((each) => keys.steps.get(each)));
    }
    /** @type {any[]} */
    const parts = [path, loop.bodies.map((body) => found.get(body))];
    parts.push(loop.feedback.map(([name, first, ref]) => [name, keyOf(first, fed), ref.path, ref.output]));
    if (steps.some((step) => known.used(step.kernel).has("iterations"))) parts.push(loop.total);
    const key = hash(JSON.stringify(parts));
    keys.loops.set(path, key);
    keys.changes.set(loop, outer);
    for (const each of inside) {
      const changing = /** @type {Set<string>} */ (varies.get(each));
      if (!changing.has(path)) continue;
      // What reads it from here on sees the last iteration.
      keys.steps.set(each, hash(JSON.stringify([key, each, loop.repeat])));
      varies.set(each, new Set([...[...changing].filter((one) => one !== path), ...ownSizes]));
    }
  }

  /** Note what a loop's iterations have in sizes or counts of their own. @param {LoopStep} loop */
  function noteSized(loop) {
    if (loop.bodies.length === 1) return;
    /** @type {Map<string, {nodes: Set<PlanNode>, orders: Set<string>}>} by path, and whether a loop */
    const versions = new Map();
    /** @type {Map<PlanNode, number>} */
    const numbers = new Map();
    for (const body of new Set(loop.bodies)) {
      /** @type {Map<string, PlanNode[]>} */
      const now = new Map();
      for (const node of everyVersion(body)) {
        const key = `${isLoop(node)} ${node.path}`;
        now.set(key, [...(now.get(key) ?? []), node]);
        if (!numbers.has(node)) numbers.set(node, numbers.size);
      }
      for (const [key, nodes] of now) {
        const known = versions.get(key) ?? { nodes: new Set(), orders: new Set() };
        nodes.forEach((node) => known.nodes.add(node));
        known.orders.add(nodes.map((node) => numbers.get(node)).join(" "));
        versions.set(key, known);
      }
    }
    for (const { nodes, orders } of versions.values()) {
      if (orders.size === 1) continue;
      for (const node of nodes) sized.set(node, new Set([...(sized.get(node) ?? []), loop.path]));
    }
  }

  for (const node of plan.nodes) add(node, { innermost: "", frames: "" }, new Map(), new Map());
  return keys;
}

/** What a step reads that belongs to one frame: given names, and buttons among its parameters.
 *  @param {Kernel} kernel @param {Object<string, any>} given */
function clockedOf(kernel, given) {
  const buttons = kernel.parameters.filter((one) => one.widget === "button").map((one) => one.name);
  const named = Object.keys(given).filter((name) => CLOCKED.has(name));
  return new Set([...named, ...buttons, ...buttons.map((name) => `${PRESSED}${name}`)]);
}

/** @param {LoopStep} loop @returns {Set<string>} */
function loopsIn(loop) {
  const inner = loop.body.filter(isLoop).flatMap((node) => [...loopsIn(node)]);
  return new Set([loop.path, ...inner]);
}

// ── A key for any text: 128 bits, quick, for telling things apart that nobody made to collide.

const SEEDS = [0x9e3779b1, 0x85ebca6b, 0xc2b2ae35, 0x27d4eb2f]; // of different bits, and odd
const FACTORS = [0x01000193, 0x5bd1e995, 0x2c1b3c6d, 0x297a2d39];

/** Four sums over the letters, each mixed at the end so that each bit of it depends on every letter.
 *  @param {string} text */
export function hash(text) {
  const sums = [...SEEDS];
  for (let index = 0; index < text.length; index++) {
    const code = text.charCodeAt(index);
    for (let k = 0; k < 4; k++) sums[k] = Math.imul(sums[k] ^ (code + (sums[k] >>> 15)), FACTORS[k]);
  }
  return sums.map((sum, k) => {
    let mixed = sum ^ text.length ^ sums[(k + 1) % 4];
    for (const factor of FACTORS) mixed = Math.imul(mixed ^ (mixed >>> 16), factor | 1);
    return ((mixed ^ (mixed >>> 15)) >>> 0).toString(16).padStart(8, "0");
  }).join("");
}
