// planner.js -- makes a sketch concrete: sizes, counts, values; as playground/engine/planner.py does.
//
// A plan is made whole where a size or a count may have changed; else the last one of the sketch stays but
// for the steps whose values are others, and the eye: moving the camera or a slider costs next to nothing.

import { isAccepted, nearestAccepted } from "./accepts.js";
import { look } from "./camera.js";
import { ownNames } from "./counts.js";
import { betweenOf, countsOf } from "./lattice.js";
import { namesIn, planError } from "./expressions.js";
import { checkShapes } from "./input_shapes.js";
import { everyVersion, isLoop, stepsOf } from "./plan_nodes.js";
import { checkedFrame, checkedSteps, checkedTime, terrainOf } from "./requests.js";
import { MAX_REPEAT, counted, measure } from "./sizes.js";
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
/** @typedef {import("./plan_nodes.js").LoopStep} LoopStep */
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

const MAP = "#map"; // the path of the step that shows a texture from above

/** @type {WeakMap<Sketch, Last>} */
const lastPlans = new WeakMap();

/** A sketch's kernels or parameters are others now: its next plan is made whole. @param {Sketch} sketch */
export const forgetPlan = (sketch) => lastPlans.delete(sketch);

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

/** The iterations in all of every repeated kernel and loop, by path: the most of one inside a loop.
 *  @param {Plan} plan @returns {Map<string, number>} */
export function repeatsOf(plan) {
  /** @type {Map<string, number>} */
  const found = new Map(), every = everyVersion(plan.nodes);
  const loops = new Set(every.filter(isLoop).map((node) => node.path));
  for (const node of every) {
    // Of a loop of one kernel, the loop is what counts, not the kernel in it.
    const own = !isLoop(node) && node.kernel.kind === "kernel" && node.kernel.repeat !== 1;
    if (isLoop(node) || (own && !loops.has(node.path))) {
      found.set(node.path, Math.max(node.whole, found.get(node.path) ?? 0));
    }
  }
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
  for (const { size, repeat } of Object.values(sketch.passes)) add([...(size ?? []), repeat ?? 1]);
  /** @param {import("./schema.js").Node} node */
  const visit = (node) => {
    if ("loop" in node) {
      node.body.forEach(visit);
    } else {
      add(countsOf(sketch.kernels[node.kernel]), node.values);
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
  /** What was returned for nodes and for several: iterations share them. @type {Map<any, any>} */
  const done = new Map();
  /** @template T @param {T} given @param {() => T} make @returns {T} */
  const once = (given, make) => {
    if (!done.has(given)) done.set(given, make());
    return done.get(given);
  };
  /** @param {PlanNode} node @returns {PlanNode} */
  const one = (node) => once(node, () => {
    if (isLoop(node)) {
      const bodies = node.bodies.map(all);
      return bodies.every((body, index) => body === node.bodies[index]) ? node : withBodies(node, bodies);
    }
    const { leaf, kernel } = node;
    if (!leaf || !Object.values(leaf.values).some((path) => changed.has(path))) return node;
    return { ...node, values: uniformValues(kernel, leaf, values) };
  });
  /** @param {PlanNode[]} nodes @returns {PlanNode[]} */
  const all = (nodes) => once(nodes, () => {
    const found = nodes.map(one);
    return found.every((node, index) => node === nodes[index]) ? nodes : found;
  });
  return changed.size ? all(last.plan.nodes) : last.plan.nodes;
}

/** A loop with other bodies.
 *  @param {Omit<LoopStep, "bodies" | "body">} loop @param {PlanNode[][]} made @returns {LoopStep} */
function withBodies(loop, made) {
  const bodies = made.every((body) => body === made[0]) ? made.slice(0, 1) : made;
  return { ...loop, bodies, body: bodies[bodies.length > 1 ? Math.max(loop.repeat - 1, 0) : 0] };
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
  const measured = measure(sketch, now.shared, { ...now, terrain: now.terrain.size }), { sizeOf } = measured;
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

  /** Iterations in all of each repeat, by path; the most where they differ.
   *  @type {Map<string, number>} */
  const most = new Map();

  /** How many of a repeat's iterations run.
   *  @param {string} path @param {number} count in all @param {boolean} followsTime */
  function stoppedAt(path, count, followsTime) {
    most.set(path, varies || followsTime ? MAX_REPEAT : Math.max(count, most.get(path) ?? 0));
    return measured.stepsOf(path, count);
  }

  /** Each step, loop and body once, whatever iterations have it. @type {Map<string, any>} */
  const made = new Map();
  /** @type {Map<object, number>} */
  const numbers = new Map();
  /** @template {object} T @param {any[]} key @param {T} one @returns {T} */
  function shared(key, one) {
    const text = JSON.stringify(key), found = made.get(text) ?? one;
    made.set(text, found);
    if (!numbers.has(found)) numbers.set(found, numbers.size);
    return found;
  }
  const numberOf = (/** @type {object} */ one) => numbers.get(one);

  /** @param {import("./schema.js").Node} node @param {string} around @returns {PlanNode} */
  function concrete(node, around) {
    if ("loop" in node) {
      const { path, followsTime, countsFrames, feedback } = node, all = measured.countOf(path);
      const repeat = stoppedAt(path, all, followsTime);
      /** @type {PlanNode[][]} */
      const bodies = [];
      measured.iterations(path, () => {
        const body = node.body.map((inside) => concrete(inside, path));
        bodies.push(shared(body.map(numberOf), body));
      });
      const loop = { path, loop: /** @type {true} */ (true), repeat, whole: all, countsFrames, followsTime };
      return shared([path, repeat, all, bodies.map(numberOf)], withBodies({ ...loop, feedback }, bodies));
    }
    const { path, inputs } = node, kernel = sketch.kernels[node.kernel];
    const size = sizeOf(path), given = uniformValues(kernel, node, values);
    refuse(node, size);
    checkShapes(sketch, node, measured.sizeOfSource);
    const own = ownNames(kernel, size, given, time);
    const all = kernel.repeat === 1 ? 1
      : counted(kernel.repeat, path, kernel.file, { name: own }, Boolean(kernel.until));
    // Of a kernel that repeats in a loop of the same path, the loop is what stops.
    const repeat = path === around ? all : stoppedAt(path, all, kernel.followsTime);
    const between = now.fills ? betweenOf(kernel, node, repeat, all, own) : null;
    const step = { path, kernel, leaf: node, values: given, inputs, size, repeat, whole: all, between };
    return shared([path, size, repeat, all, between], step);
  }

  const found = nodes.map((node) => concrete(node, ""));
  for (const [path, steps] of Object.entries(now.stopped)) {
    const count = most.get(path) ?? steps;
    if (steps > count) {
      throw planError(`steps: '${path}' stops after ${steps} steps, but it has ${count} in all`, "");
    }
  }
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
