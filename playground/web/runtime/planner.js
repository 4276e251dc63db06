// planner.js -- makes a sketch concrete: sizes, counts, values; as playground/engine/planner.py does.
//
// A plan is made whole where a size or a count may have changed; else the last one of the sketch stays but
// for the steps whose values are others, and the eye: moving the camera or a slider costs next to nothing.

import { isAccepted, nearestAccepted } from "./accepts.js";
import { look } from "./camera.js";
import { betweenOf, ownNames } from "./counts.js";
import { integer, isPlanError, namesIn, planError, textOf } from "./expressions.js";
import { checkShapes } from "./input_shapes.js";
import { stepsOf } from "./plan_nodes.js";
import { checkedFrame, checkedSteps, checkedTime, terrainOf } from "./requests.js";
import { measure, nameOf } from "./sizes.js";
import { cameraAt, givenTo, isSame, leavesOf, valuesAt } from "./values.js";

/** @typedef {import("./schema.js").Sketch} Sketch */
/** @typedef {import("./schema.js").Shared} Shared */
/** @typedef {import("./schema.js").Kernel} Kernel */
/** @typedef {import("./schema.js").Value} Value */
/** @typedef {import("./schema.js").Camera} Camera */
/** @typedef {import("./requests.js").State} State */
/** @typedef {import("./requests.js").Metres} Metres */
/** @typedef {import("./schema.js").Leaf} Leaf */
/** @typedef {import("./schema.js").Expression} Expression */
/** @typedef {import("./plan_nodes.js").Step} Step */
/** @typedef {import("./plan_nodes.js").PlanNode} PlanNode */
/** @typedef {import("./plan_nodes.js").Ref} Ref */

/** @typedef {object} Plan
 *  @property {PlanNode[]} nodes      all of them; `needed` of plan_nodes.js tells those of a texture
 *  @property {Metres} terrain
 *  @property {Camera} camera
 *  @property {ReturnType<typeof look>} eye
 *  @property {number} time
 *  @property {[number, number]} frame
 *  @property {Ref} picture
 *  @property {Map<string, Step>} steps  by path
 *  @property {Object<string, number>} stopped  repeats that are stopped early, by path */

/** @typedef {{plan: Plan, values: Object<string, Value>, place: string}} Last */

const MAX_REPEAT = 1_000_000;
const MAP = "#map"; // the path of the step that shows a texture from above

/** @type {WeakMap<Sketch, Last>} */
const lastPlans = new WeakMap();

/** Make a sketch concrete for one frame. Throws a `PlanError` in a sentence.
 *  @param {Sketch} sketch @param {Shared} shared @param {State} [state] @returns {Plan} */
export function makePlan(sketch, shared, state = {}) {
  const time = checkedTime(state.time ?? sketch.time), frame = checkedFrame(state.frame ?? sketch.frame);
  const values = valuesAt(sketch, state.values ?? {}, time);
  const camera = cameraAt(sketch, state.camera ?? null, time);
  const terrain = terrainOf(sketch, state), stopped = checkedSteps(sketch, state.steps ?? sketch.steps);
  const map = state.map ?? null, fills = state.interpolated ?? true;
  const { paths, byTime } = namedBy(sketch);
  const named = paths.map((path) => values[path]);
  const place = JSON.stringify([frame, terrain.size, stopped, fills, map, named, byTime ? time : 0]);
  const last = lastPlans.get(sketch);
  const eye = look(camera, terrain.extent, terrain.relief, frame);
  const known = last && last.place === place ? renewed(last, values) : null;
  const nodes = known ?? planned({ sketch, shared, values, terrain, frame, time, stopped, fills, map });
  const steps = last && nodes === last.plan.nodes ? last.plan.steps
    : new Map(stepsOf(nodes).map((step) => [step.path, step]));
  const shown = map ? { path: MAP, output: sketch.kernels[sketch.map.kernel].outputs[0].name } : null;
  const plan = { nodes, terrain, camera, eye, time, frame, picture: shown ?? sketch.picture, steps, stopped };
  lastPlans.set(sketch, { plan, values, place });
  return plan;
}

/** The iterations in all of every repeated kernel and loop, by path.
 *  @param {Plan} plan @returns {Map<string, number>} */
export function repeatsOf(plan) {
  /** @type {Map<string, number>} */
  const found = new Map();
  /** @param {PlanNode} node */
  const add = (node) => {
    const repeats = "loop" in node || (node.kernel.kind === "kernel" && node.kernel.repeat !== 1);
    if (repeats && !found.has(node.path)) found.set(node.path, node.whole);
    if ("loop" in node) node.body.forEach(add);
  };
  plan.nodes.forEach(add);
  return found;
}

// ── what sizes and counts depend on ──────────────────────────────────────────

/** @type {WeakMap<Sketch, {paths: string[], byTime: boolean}>} */
const named = new WeakMap();

/** The paths of the values that a size or a count of a sketch names, and whether one of them names a clock.
 *  @param {Sketch} sketch */
function namedBy(sketch) {
  let found = named.get(sketch);
  if (found) return found;
  const paths = new Set();
  let byTime = false;
  /** @param {Expression[]} expressions @param {Object<string, string>} [own] parameter → path */
  const add = (expressions, own = {}) => {
    for (const [kind, name] of expressions.flatMap(namesIn)) {
      if (kind === "value" || kind === "picture") paths.add(name);
      else if (kind === "name" && Object.hasOwn(own, name)) paths.add(own[name]);
      else if (name === "time" || name === "frames") byTime = true;
    }
  };
  for (const pass of Object.values(sketch.passes)) add(pass.size ?? []);
  /** @param {import("./schema.js").Node} node */
  const visit = (node) => {
    if ("loop" in node) {
      add([node.repeat]);
      node.body.forEach(visit);
    } else {
      const { repeat, stride } = sketch.kernels[node.kernel];
      add([repeat, stride ?? 1], node.values);
    }
  };
  sketch.nodes.forEach(visit);
  found = { paths: [...paths], byTime };
  named.set(sketch, found);
  return found;
}

/** The nodes of a plan with the values of now: the very ones where nothing in them has changed.
 *  @param {Last} last @param {Object<string, Value>} values */
function renewed(last, values) {
  const changed = new Set(Object.keys(values).filter((path) => !isSame(values[path], last.values[path])));
  /** @param {PlanNode} node @returns {PlanNode} */
  const one = (node) => {
    if ("loop" in node) {
      const body = all(node.body);
      return body === node.body ? node : { ...node, body };
    }
    const { leaf, kernel } = node;
    if (!leaf || !Object.values(leaf.values).some((path) => changed.has(path))) return node;
    return { ...node, values: uniformValues(kernel, leaf, values) };
  };
  /** @param {PlanNode[]} nodes */
  const all = (nodes) => {
    const found = nodes.map(one);
    return found.every((node, index) => node === nodes[index]) ? nodes : found;
  };
  return changed.size ? all(last.plan.nodes) : last.plan.nodes;
}

/** What a leaf's uniforms get, by parameter.
 *  @param {Kernel} kernel @param {Leaf} leaf @param {Object<string, Value>} values */
const uniformValues = (kernel, leaf, values) => Object.fromEntries(kernel.parameters.map((uniform) => {
  return [uniform.name, givenTo(uniform, values[leaf.values[uniform.name]])];
}));

// ── making it whole ──────────────────────────────────────────────────────────

/** @param {{sketch: Sketch, shared: Shared, values: Object<string, Value>, terrain: Metres, time: number,
 *           frame: [number, number], stopped: Object<string, number>, fills: boolean,
 *           map: State["map"]}} now */
function planned(now) {
  const { sketch, values, time, map } = now;
  const { sizeOf, names } = measure(sketch, now.shared, { ...now, terrain: now.terrain.size });
  const varies = sketch.tracks.some((track) => track.of === "value");
  const ofView = (/** @type {string} */ path) => path === "view" || path.startsWith("view.");
  const nodes = map && !ofView(map.path) ? sketch.nodes.filter((node) => !ofView(node.path)) : sketch.nodes;
  // What has the terrain's own size first: the others' sizes follow from it.
  for (const leaf of leavesOf(nodes)) {
    const { size, own } = sketch.passes[leaf.path];
    if (!size && !own) refuse(leaf, sizeOf(leaf.path));
  }

  /** @param {Leaf} leaf @param {[number, number]} size */
  function refuse(leaf, size) {
    const { accepts, accepted, name } = sketch.kernels[leaf.kernel];
    if (!accepted || isAccepted(accepted, size)) return;
    const near = nearestAccepted(accepted, size).map(([x, y]) => `${x} x ${y}`).join(" or ");
    const message = `takes ${accepts} texels a side, not ${size.join(" x ")}; the nearest it takes: ${near}`;
    throw planError(`pass '${leaf.path}' (${name}) ${message}`, sketch.passes[leaf.path].where);
  }

  /** How many iterations; `name` is of what says so, and `where` a mistake is.
   *  @param {Expression} repeat @param {string} name @param {string} where
   *  @param {import("./expressions.js").Names} known */
  function counted(repeat, name, where, known) {
    try {
      const count = integer(repeat, known);
      if (count >= 0n && count <= MAX_REPEAT) return Number(count);
      const message = `repeat '${textOf(repeat)}' gives ${count}; 0 to ${MAX_REPEAT} were expected`;
      throw planError(`pass '${name}': ${message}`, where);
    } catch (error) {
      if (!isPlanError(error) || error.where !== undefined) throw error;
      throw planError(`pass '${name}': repeat ${error.message}`, where);
    }
  }

  /** How many of a repeat's iterations run.
   *  @param {string} path @param {number} count in all @param {boolean} followsTime */
  function stoppedAt(path, count, followsTime) {
    const steps = now.stopped[path] ?? count;
    if (steps > count && !varies && !followsTime) {
      throw planError(`steps: '${path}' stops after ${steps} steps, but it has ${count} in all`, "");
    }
    return Math.min(steps, count);
  }

  /** @param {import("./schema.js").Node} node @param {string} around @returns {PlanNode} */
  function concrete(node, around) {
    if ("loop" in node) {
      const { path, followsTime, countsFrames, feedback } = node;
      const all = counted(node.repeat, nameOf(path), sketch.passes[path].where, names);
      const repeat = stoppedAt(path, all, followsTime);
      const body = node.body.map((inside) => concrete(inside, path));
      return { path, loop: true, repeat, whole: all, countsFrames, followsTime, body, feedback };
    }
    const { path, inputs } = node, kernel = sketch.kernels[node.kernel];
    const size = sizeOf(path), given = uniformValues(kernel, node, values);
    refuse(node, size);
    checkShapes(sketch, node, sizeOf);
    const own = ownNames(kernel, size, given, time);
    const all = kernel.repeat === 1 ? 1 : counted(kernel.repeat, path, kernel.file, { name: own });
    // Of a kernel that repeats in a loop of the same path, the loop is what stops.
    const repeat = path === around ? all : stoppedAt(path, all, kernel.followsTime);
    const between = now.fills ? betweenOf(kernel, node, repeat, all, own) : null;
    return { path, kernel, leaf: node, values: given, inputs, size, repeat, whole: all, between };
  }

  const found = nodes.map((node) => concrete(node, ""));
  return map ? [...found, mapStep(sketch, map, sizeOf(ofView(map.path) ? "view" : "#frame"))] : found;
}

/** The step that shows a texture from above.
 *  @param {Sketch} sketch @param {NonNullable<State["map"]>} map @param {[number, number]} size
 *  @returns {Step} */
function mapStep(sketch, map, size) {
  const kernel = sketch.kernels[sketch.map.kernel];
  const chosen = { ...sketch.map.values, ...map.values };
  const values = Object.fromEntries(kernel.parameters.map((uniform) => {
    return [uniform.name, givenTo(uniform, chosen[uniform.name])];
  }));
  /** @type {[string, import("./schema.js").Source | null][]} */
  const inputs = kernel.inputs.map(({ name }) => {
    return [name, name === sketch.map.input ? { path: map.path, output: map.output } : null];
  });
  return { path: MAP, kernel, leaf: null, values, inputs, size, repeat: 1, whole: 1, between: null };
}
