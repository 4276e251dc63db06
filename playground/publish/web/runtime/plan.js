// plan.js -- fills in a sketch's plan: sizes, counts and values of now, as playground/engine/planner.py.
//
// Where no size and no count is another, the last plan of the sketch stays but for the steps whose values are
// others, and the eye: moving the camera or a slider costs next to nothing.

import { look } from "./camera.js";
import {
  betweenOf, clockOf, evaluated, headerNames, isPlanError, planError, textOf, whole,
} from "./formulas.js";
import { isOfView } from "./map_view.js";
import { everyVersion, isLoop, stepsOf } from "./plan_nodes.js";
import { cameraAt, givenTo, isSame, leavesOf, valuesAt } from "./values.js";

/** @import { LoopStep, PlanNode, Ref, Step } from "./plan_nodes.js"
 *  @import { Camera, Formula, Kernel, Leaf, Sketch, Value } from "./schema.js" */

// ── The sizes that a kernel takes: playground/shader/expressions.py.

/** @typedef {[number, number, number][]} Runs */

/** The accepted sizes just below and just above one: itself alone where it is accepted.
 *  @param {import("./schema.js").Accepted} accepted @param {[number, number]} size
 *  @returns {[number, number][]} */
export function nearestAccepted(accepted, size) {
  const [xs, ys = xs] = accepted, longest = Math.max(...size);
  const [x, y] = accepted.length === 1 ? [longest, longest] : size;
  const [low, high] = [[below(xs, x), below(ys, y)], [above(xs, x), above(ys, y)]];
  const found = /** @type {[number, number][]} */ ([low, high]);
  return String(low) === String(high) ? found.slice(1) : found;
}

/** The largest number of runs that is not above a side, else the smallest there is.
 *  @param {Runs} runs @param {number} side */
function below(runs, side) {
  const run = runs.filter(([first]) => first <= side).pop();
  if (!run) return runs[0][0];
  const [first, last, step] = run;
  return first + Math.floor((Math.min(side, last) - first) / step) * step;
}

/** The smallest number of runs that is not below a side, else the largest there is.
 *  @param {Runs} runs @param {number} side */
function above(runs, side) {
  const run = runs.find(([, last]) => last >= side);
  if (!run) return runs[runs.length - 1][1];
  const [first, , step] = run;
  return first + Math.ceil(Math.max(side - first, 0) / step) * step;
}

// ── What a plan is made for besides its sketch, and checks of it: engine/plan.py.

/** @typedef {[number, number]} Size */

/** @typedef {{size: Size, extent: Size, relief: number, base_elevation: number}} Metres */

/** What a plan is made for: `values` by path over the sketch's, `steps` repeats that are stopped early,
 *  `map` a texture shown from above in place of the view, with values of the map's own parameters.
 *  @typedef {object} State
 *  @property {Object<string, Value>} [values]
 *  @property {{size: Size, extent: Size | null, relief: number, base_elevation: number}} [terrain]
 *      extent null: as the sketch has it, or as its size is where nothing says it
 *  @property {Camera | null} [camera]          null: as the sketch and its keyframes have it
 *  @property {Size} [frame]                    pixels
 *  @property {number} [time]                   seconds
 *  @property {Object<string, number>} [steps]  iterations after which a repeat stops, by path
 *  @property {boolean} [interpolated]          what a stopped repeat has not computed is filled in
 *  @property {{path: string, output: string, values: Object<string, Value>} | null} [map]
 *  @property {import("./plain.js").Live} [live]  what the pointer and the clock of the page say */

export const MAX_SIDE = 16384;

/** @param {number} time */
function checkedTime(time) {
  if (!Number.isFinite(time)) throw planError(`time ${time}: expected a number of seconds`, "");
  return time;
}

/** @param {[number, number]} frame @returns {[number, number]} */
function checkedFrame([width, height]) {
  const fits = [width, height].every((side) => Number.isInteger(side) && side >= 1 && side <= MAX_SIDE);
  if (fits) return [width, height];
  throw planError(`a picture of ${width} x ${height} pixels; 1 to ${MAX_SIDE} a side were expected`, "");
}

/** @param {Sketch} sketch @param {State} state @returns {Metres} */
export function terrainOf(sketch, state) {
  const { size, extent, relief, base_elevation } = { ...sketch.terrain, ...state.terrain };
  /** @param {boolean} fits @param {string} name @param {number | number[]} value @param {string} wanted */
  const check = (fits, name, value, wanted) => {
    if (!fits) throw planError(`${name} = '${[value].flat().join("x")}': expected ${wanted}`, "");
  };
  const sides = size.every((side) => Number.isInteger(side) && side >= 1 && side <= MAX_SIDE);
  check(sides, "size", size, `1 to ${MAX_SIDE} texels a side, as 513 or 513x257`);
  const own = sketch.terrain, unset = !extent || isSame(extent, own.extent);
  const metres = !unset ? extent : own.extentFollows ? withSides(own.extent[0], size) : own.extent;
  const above0 = metres.every((side) => side > 0 && side < 1e9);
  check(above0, "extent", metres, "metres above 0, as 10240 or 10240x8000");
  check(relief >= 0 && relief < 1e9, "relief", relief, "a number of metres, 0 or more");
  check(Math.abs(base_elevation) < 1e9, "base_elevation", base_elevation, "a number of metres");
  return { size: [size[0], size[1]], extent: [metres[0], metres[1]], relief, base_elevation };
}

/** The extent of a terrain whose sides are to each other as its texels are.
 *  @param {number} wide [m] @param {Size} size @returns {Size} */
const withSides = (wide, size) => [wide, wide * ((size[1] - 1) / Math.max(size[0] - 1, 1) || 1)];

/** Return after how many iterations repeats stop, by the paths of what repeats.
 *  @param {Sketch} sketch @param {Object<string, number>} steps */
function checkedSteps(sketch, steps) {
  const repeated = repeatedPaths(sketch);
  /** @type {Object<string, number>} */
  const found = {};
  for (const [path, count] of Object.entries(steps)) {
    const inside = repeated.filter((name) => name.startsWith(`${path}.`));
    const name = repeated.includes(path) ? path : inside.length === 1 ? inside[0] : "";
    if (!name) throw planError(`steps: no repeated pass '${path}' in sketch ${sketch.name}`, "");
    if (!Number.isInteger(count) || count < 0) {
      throw planError(`steps: '${path}' stops after ${count} steps; expected a whole number from 0`, "");
    }
    found[name] = count;
  }
  return found;
}

/** @param {Sketch} sketch */
function repeatedPaths(sketch) {
  /** @param {import("./schema.js").Node[]} nodes @returns {string[]} */
  const loops = (nodes) => nodes.flatMap((node) => ("loop" in node ? [node.path, ...loops(node.body)] : []));
  const kernels = leavesOf(sketch.nodes).filter((leaf) => sketch.kernels[leaf.kernel].repeat !== 1);
  return [...new Set([...loops(sketch.nodes), ...kernels.map((leaf) => leaf.path)])];
}

// ── Fills in a sketch's plan

/** @typedef {object} Plan
 *  @property {PlanNode[]} nodes      all of them; `needed` of plan_nodes.js tells those of a texture
 *  @property {Metres} terrain
 *  @property {Camera} camera
 *  @property {ReturnType<typeof look>} eye
 *  @property {number} time
 *  @property {Size} frame
 *  @property {Ref} picture
 *  @property {Map<string, Step>} steps  by path
 *  @property {Object<string, number>} stopped  repeats that are stopped early, by path
 *  @property {Set<string>} continued  the draws that a later draw goes on from, by path */

/** What the nodes of a plan are made for.
 *  @typedef {{values: Object<string, Value>, terrain: Size, frame: Size, time: number,
 *             stopped: Object<string, number>, fills: boolean, map: State["map"]}} Now */

const MAP = "#map"; // the path of the step that shows a texture from above
const MAX_REPEAT = 1_000_000;
const MAX_BOUND = 2 ** 31 - 1; // of a repeat that ends by itself: what GLSL counts
const MAX_COUNTED = 1024; // iterations of a loop of which each may have its own sizes: each is planned

/** Make a sketch concrete for one frame. Throws a `PlanError` in a sentence.
 *  @param {Sketch} sketch @param {State} [state] @returns {Plan} */
export function makePlan(sketch, state = {}) {
  const time = checkedTime(state.time ?? sketch.time), frame = checkedFrame(state.frame ?? sketch.frame);
  const values = valuesAt(sketch, state.values ?? {}, time);
  const camera = cameraAt(sketch, state.camera ?? null, time);
  const terrain = terrainOf(sketch, state), stopped = checkedSteps(sketch, state.steps ?? sketch.steps);
  const map = state.map ?? null, fills = state.interpolated ?? true;
  const { kernels, named } = sketch, clock = sketch.namesTime ? time : 0;
  const counted = named.map((path) => values[path]), last = lastPlans.get(sketch);
  const basis = JSON.stringify([frame, terrain.size, stopped, fills, map, clock, counted]);
  const nodes = last?.basis === basis && last.kernels === kernels ? updated(last, values)
    : planned(sketch, { values, terrain: terrain.size, frame, time, stopped, fills, map });
  const steps = nodes === last?.plan.nodes ? last.plan.steps
    : new Map(stepsOf(nodes).map((step) => [step.path, step]));
  const shown = map ? { path: MAP, output: kernels[sketch.map.kernel].outputs[0].name } : null;
  const eye = look(camera, terrain.extent, terrain.relief, frame);
  const picture = shown ?? sketch.picture, continued = new Set(sketch.continued);
  const plan = { nodes, terrain, camera, eye, time, frame, picture, steps, stopped, continued };
  lastPlans.set(sketch, { plan, values, basis, kernels });
  return plan;
}

/** A plan, with what its sizes and counts were worked out of.
 *  @typedef {{plan: Plan, values: Object<string, Value>, basis: string, kernels: Kernel[]}} Last */

/** @type {WeakMap<Sketch, Last>} */
const lastPlans = new WeakMap();

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
      found.set(node.path, Math.max(node.total, found.get(node.path) ?? 0));
    }
  }
  return found;
}

// ── sizes and counts ─────────────────────────────────────────────────────────

/** The sizes of passes and the counts of loops. Those inside a loop that counts are of the iteration that
 *  `within` acts in.
 *  @param {Sketch} sketch @param {Now} now */
function createSizes({ passes }, now) {
  /** @type {Object<string, Size>} */
  const bases = { "#terrain": now.terrain, "#frame": now.frame };
  /** The iteration of each counting loop around what is worked out. @type {Object<string, number>} */
  let at = {};
  let atText = "";
  /** @type {Map<string, any>} */
  const known = new Map();
  /** @type {string[]} */
  const open = [];

  /** @type {import("./formulas.js").Names} */
  const names = {
    name: (name) => clockOf(name, now.time),
    size: (path, axis) => sizeOf(path)[axis],
    value: (path, menu) => Number(menu ? menu[Number(now.values[path])] : now.values[path]),
    iteration: (loop) => at[loop],
    iterations: (loop) => Math.max(countOf(loop), 1),
    last: (loop, inner) => inIteration(loop, Math.max(runOf(loop, countOf(loop)) - 1, 0), inner),
    before: (loop, start, inner) => (
      at[loop] ? inIteration(loop, at[loop] - 1, inner) : evaluated(start, names)),
  };

  /** Work something out in an iteration of a loop.
   *  @template T @param {string} loop @param {number} iteration @param {() => T} act @returns {T} */
  function within(loop, iteration, act) {
    const around = at, text = atText;
    at = { ...at, [loop]: iteration };
    atText = JSON.stringify(at);
    try {
      return act();
    } finally {
      [at, atText] = [around, text];
    }
  }

  /** @param {string} loop @param {number} iteration @param {Formula} inner @returns {number} */
  const inIteration = (loop, iteration, inner) => within(loop, iteration, () => evaluated(inner, names));

  /** @template T @param {string} what @param {() => T} act @returns {T} */
  function once(what, act) {
    const key = what + atText;
    if (!known.has(key)) known.set(key, act());
    return known.get(key);
  }

  /** How many of a repeat's iterations run. @param {string} path @param {number} all */
  const runOf = (path, all) => Math.min(now.stopped[path] ?? all, all);

  /** @param {string} loop */
  const countOf = (loop) => once(`count ${loop}`, () => {
    const { repeat = 1, where } = passes[loop];
    return counted(repeat, nameOf(loop), where, names);
  });

  /** @param {string | Size} size texels, a base, or the path of the pass whose size it is @returns {Size} */
  const sizeOf = (size) =>
    (typeof size === "string" ? bases[size] ?? once(`size ${size}`, () => sizeOfPass(size)) : size);

  /** @param {string} path @returns {Size} */
  function sizeOfPass(path) {
    const { size = [], where } = passes[path];
    if (open.includes(path)) {
      throw planError(`the sizes of ${open.join(" and ")} depend on each other`, where);
    }
    open.push(path);
    const sides = () => size.map((side) => whole(side, names));
    const [x, y] = placed(`pass '${nameOf(path)}': size`, where, sides), iteration = Object.values(at).pop();
    open.pop();
    if (Math.min(x, y) >= 1 && Math.max(x, y) <= MAX_SIDE) return [x, y];
    const when = iteration === undefined ? "" : ` in iteration ${iteration}`;
    const message = `size ${x} x ${y}${when}; 1 to ${MAX_SIDE} a side were expected`;
    throw planError(`pass '${nameOf(path)}': ${message}`, where);
  }

  return { sizeOf, countOf, runOf, within };
}

/** How many iterations a repeat gives; `name` is of what says so, and `where` a mistake is.
 *  @param {Formula} repeat @param {string} name @param {string} where
 *  @param {import("./formulas.js").Names} names @param {number} [most] */
function counted(repeat, name, where, names, most = MAX_REPEAT) {
  const count = placed(`pass '${name}': repeat`, where, () => whole(repeat, names));
  if (count >= 0 && count <= most) return count;
  const message = `repeat '${textOf(repeat)}' gives ${count}; 0 to ${most} were expected`;
  throw planError(`pass '${name}': ${message}`, where);
}

/** Place a mistake in a formula.
 *  @template T @param {string} what @param {string} where @param {() => T} act */
function placed(what, where, act) {
  try {
    return act();
  } catch (error) {
    if (!isPlanError(error) || error.where !== undefined) throw error; // of another pass
    throw planError(`${what} ${error.message}`, where);
  }
}

/** The last name of a path. @param {string} path */
const nameOf = (path) => path.slice(path.lastIndexOf(".") + 1);

/** Refuse a size that a kernel does not take. @param {Sketch} sketch @param {Leaf} leaf @param {Size} size */
function refuse(sketch, leaf, size) {
  const { accepts, accepted, name } = sketch.kernels[leaf.kernel];
  if (!accepted) return;
  const near = nearestAccepted(accepted, size);
  if (String(near) === String(size)) return;
  const listed = near.map(([x, y]) => `${x} x ${y}`).join(" or ");
  const message = `takes ${accepts} texels a side, not ${size.join(" x ")}; the nearest it takes: ${listed}`;
  throw planError(`pass '${leaf.path}' (${name}) ${message}`, sketch.passes[leaf.path].where);
}

// ── steps and loops ──────────────────────────────────────────────────────────

/** The nodes of a plan with the values of now: the very ones where nothing in them has changed.
 *  @param {Last} last @param {Object<string, Value>} values */
function updated(last, values) {
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

/** @param {Sketch} sketch @param {Now} now @returns {PlanNode[]} */
function planned(sketch, now) {
  const { values, time, map } = now, sizes = createSizes(sketch, now), { sizeOf } = sizes;
  const varies = sketch.tracks.some((track) => track.of === "value");
  const nodes = !map || isOfView(map.path) ? sketch.nodes
    : sketch.nodes.filter((node) => !isOfView(node.path));
  // What has the terrain's own size first: the others' sizes follow from it.
  for (const leaf of leavesOf(nodes)) {
    if (leaf.size === "#terrain" || leaf.size === "#frame") refuse(sketch, leaf, sizeOf(leaf.size));
  }

  /** Iterations in all of each repeat, by path; the most where they differ. @type {Map<string, number>} */
  const most = new Map();
  /** How many of a repeat's iterations run.
   *  @param {string} path @param {number} all @param {boolean} followsTime */
  function stoppedAt(path, all, followsTime) {
    most.set(path, varies || followsTime ? MAX_REPEAT : Math.max(all, most.get(path) ?? 0));
    return sizes.runOf(path, all);
  }

  /** Each step, loop and body once, whatever iterations have it, and a number of each.
   *  @type {Map<string, any>} */
  const parts = new Map();
  /** @type {Map<object, number>} */
  const numbers = new Map();
  /** @template {object} T @param {string} key @param {T} made @returns {T} */
  function shared(key, made) {
    const part = parts.get(key) ?? made;
    parts.set(key, part);
    if (!numbers.has(part)) numbers.set(part, numbers.size);
    return part;
  }
  const numbersOf = (/** @type {object[]} */ several) => several.map((part) => numbers.get(part)).join();

  /** @param {import("./schema.js").Node} node @param {string} around @returns {PlanNode} */
  function concrete(node, around) {
    if (!("loop" in node)) return concreteStep(node, around);
    const { path, followsTime, countsFrames, counting, feedback } = node, all = sizes.countOf(path);
    if (counting && all > MAX_COUNTED) {
      const { repeat = 1, where } = sketch.passes[path];
      const message = `repeat '${textOf(repeat)}' gives ${all}; 0 to ${MAX_COUNTED}`;
      const why = "were expected where a size or a repeat inside names the iteration";
      throw planError(`pass '${nameOf(path)}': ${message} ${why}`, where);
    }
    const repeat = stoppedAt(path, all, followsTime);
    const body = () => {
      const made = node.body.map((inside) => concrete(inside, path));
      return shared(`body ${numbersOf(made)}`, made);
    };
    const bodies = counting
      ? Array.from({ length: Math.max(all, 1) }, (_, number) => sizes.within(path, number, body)) : [body()];
    const loop = { path, loop: /** @type {true} */ (true), repeat, total: all, countsFrames, followsTime };
    const key = `loop ${path} ${repeat} ${all} ${numbersOf(bodies)}`;
    return shared(key, withBodies({ ...loop, feedback }, bodies));
  }

  /** @param {Leaf} leaf @param {string} around @returns {Step} */
  function concreteStep(leaf, around) {
    const { path, inputs } = leaf, kernel = sketch.kernels[leaf.kernel], size = sizeOf(leaf.size);
    refuse(sketch, leaf, size);
    const own = { path, kernel, leaf, values: uniformValues(kernel, leaf, values), inputs, size };
    const all = kernel.repeat === 1 ? 1 : counted(
      kernel.repeat, path, kernel.file, headerNames(own, time), kernel.until ? MAX_BOUND : MAX_REPEAT);
    // Of a kernel that repeats in a loop of the same path, the loop is what stops.
    const repeat = path === around ? all : stoppedAt(path, all, kernel.followsTime);
    const step = { ...own, repeat, total: all }, between = now.fills ? betweenOf(step, time) : null;
    const { k_stride, k_form } = between ?? { k_stride: 0, k_form: 0 };
    return shared(`${path} ${size} ${repeat} ${all} ${k_stride} ${k_form}`, { ...step, between });
  }

  const made = nodes.map((node) => concrete(node, ""));
  for (const [path, steps] of Object.entries(now.stopped)) {
    const all = most.get(path) ?? steps;
    if (steps > all) {
      throw planError(`steps: '${path}' stops after ${steps} steps, but it has ${all} in all`, "");
    }
  }
  if (!map) return made;
  return [...made, mapStep(sketch, map, sizeOf(isOfView(map.path) ? sketch.map.size : "#frame"))];
}

/** The step that shows a texture from above.
 *  @param {Sketch} sketch @param {NonNullable<State["map"]>} map @param {Size} size @returns {Step} */
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
  return { path: MAP, kernel, leaf: null, values, inputs, size, repeat: 1, total: 1, between: null };
}
