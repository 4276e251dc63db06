// execution.js -- runs the passes of one plan in order: takes known results, computes stale ones, iterates.
//
// What an iteration of a loop computes belongs to the loop until its next iteration is done; all else
// belongs to the cache. A pass inside a loop that does not change with it runs once.

import { isSize } from "./binder.js";
import { failure } from "./context.js";
import { started } from "./draws.js";
import { bodyOf, isLoop, readWithLevels, stepsOf } from "./plan_nodes.js";
import { texelsOf } from "./textures.js";

/** @import { Wired } from "./binder.js"
 *  @import { Cached } from "./cache.js"
 *  @import { Job } from "./kernels.js"
 *  @import { Plan } from "./plan.js"
 *  @import { LoopStep, Ref, Step } from "./plan_nodes.js"
 *  @import { Source } from "./schema.js"
 *  @import { Result } from "./textures.js" */

/** @typedef {Step | LoopStep} PlanNode */
/** @typedef {Map<string, Wired | null>} Fed  what loops feed back, by loop and name */

/** What a run needs of its engine and its player.
 *  @typedef {object} Around
 *  @property {import("./staleness.js").Keys} keys
 *  @property {import("./cache.js").Cache} cache
 *  @property {import("./textures.js").Textures} textures
 *  @property {import("./kernels.js").Kernels} kernels
 *  @property {ReturnType<typeof import("./draws.js").createDraws>} draws
 *  @property {ReturnType<typeof import("./plain.js").createPlain>} plain
 *  @property {import("./textures.js").Images} images
 *  @property {WebGL2RenderingContext} gl
 *  @property {(step: Step, frame: number | null) => Object<string, any>} given
 *  @property {(kernel: import("./schema.js").Kernel) => import("./kernel_texts.js").KernelText} text
 *  @property {(step: Step) => number} samples
 *  @property {(text: import("./kernel_texts.js").KernelText, width: number, height: number) => number} rows
 *  @property {() => void} cancel   give up this run: another needs what it is at
 *  @property {(job: Job, made: Result) => void} [computed]   of a loop's step, its inputs are there */

/** A generator of pieces of work. @template T
 *  @typedef {Generator<any, T, boolean | undefined>} Working */

/** @param {Plan} plan @param {PlanNode[]} nodes what to run of it @param {Around} around */
export const createExecution = (plan, nodes, around) => {
  const { keys, cache, textures, kernels, draws, plain, images, gl } = around;
  /** @type {Map<string, Result>} by the step's path */
  const results = new Map();
  /** @type {string[]} */
  const ran = [];
  /** @type {Set<string>} keys */
  const used = new Set();
  /** @type {Set<PlanNode>} */
  const done = new Set();
  /** @type {Map<string, [Step, string]>} the output that a loop feeds back */
  const fedFrom = new Map();
  /** @type {Map<string, Result>} */
  const zeros = new Map();
  const steps = new Map(stepsOf(plan.nodes).map((step) => [step.path, step]));
  const tall = readWithLevels(plan.nodes);
  const { continued } = plan;
  /** The loops whose iterations change a node. @param {PlanNode} node */
  const changesOf = (node) => keys.changes.get(node) || new Set();

  /** Run nodes in order: those that change with no loop, and loops from their first iteration on.
   *  @param {PlanNode[]} list @returns {Working<void>} */
  const run = function* (list) {
    for (const node of list) {
      if (!changesOf(node).size) yield* runOnce(node);
      else if (isLoop(node)) yield* run(node.body);
    }
  };

  /** @param {PlanNode} node @returns {Working<void>} */
  const runOnce = function* (node) {
    if (done.has(node)) return;
    done.add(node);
    if (isLoop(node)) yield* runCachedLoop(node);
    else results.set(node.path, unchangedDraw(node) || (yield* known(node)));
  };

  /** Return the earlier draw's result for a step that draws nothing over it, samples and depth too.
   *  @param {Step} step @returns {Result | null} */
  const unchangedDraw = (step) => {
    if (step.kernel.kind !== "draw" || step.repeat) return null;
    const start = wiredTo(step.inputs.find(([name]) => name === "initial")?.[1] || null, new Map());
    if (!start || !continuesFrom(start) || !isSize(start.result.size, step.size)) return null;
    const owner = start.result.of || start.result;
    const made = started(step.kernel.outputs, start);
    return made.size < step.kernel.outputs.length ? null : textures.result(step.size, made, { of: owner });
  };

  /** Whether what is wired is a draw's. @param {Wired} wired */
  const continuesFrom = ({ result }) => !!pathOf(result);

  /** The path of the draw that a result is of, if it is a draw's that others go on from.
   *  @param {Result} result */
  const pathOf = (result) => {
    const owner = result.of || result;
    for (const path of continued)
      if (results.get(path) === owner && steps.get(path)?.kernel.kind === "draw") return path;
    return "";
  };

  /** Return a step's result: known, or computed; of a stopped step interpolated.
   *  @param {Step} step @returns {Working<Result>} */
  const known = function* (step) {
    const key = /** @type {string} */ (keys.steps.get(step.path)), found = cache.get(key, used);
    if (found) return [...found.results.values()][0];
    if (!step.between) return yield* computed(step);
    const raw = cache.get(/** @type {string} */ (keys.raw.get(step.path)), used);
    const from = raw ? [...raw.results.values()][0] : yield* computed(step);
    const { kernel, between } = step;
    const made = kernels.drawnOwn("fill_between.frag", from, between, kernel.outputs, isTall(step));
    return keep(key, step, made);
  };

  /** Keep a result under its key, and return it. @param {string} key @param {Step} step
   *  @param {Result} made */
  const keep = (key, step, made) => {
    const { results } = cache.put(key, { results: new Map([[step.path, made]]), iterations: 0 }, used);
    return /** @type {Result} */ (results.values().next().value);
  };

  /** Run a step, from where its earlier iterations are known. @param {Step} step
   *  @returns {Working<Result>} */
  const computed = function* (step) {
    const key = /** @type {string} */ (keys.raw.get(step.path));
    const unfinished = /** @type {string} */ (keys.unfinished.get(step.path));
    const goesOn = step.kernel.kind === "kernel" && step.kernel.repeat !== 1;
    const start = goesOn ? earlier(step, unfinished) : null;
    /** @type {Map<string, Wired | null>} */
    const inputs = new Map();
    for (const [name, source] of step.inputs) inputs.set(name, wiredTo(source, new Map()));
    const job = jobOf(step, inputs, null, start?.result ?? null);
    let made;
    try {
      made = keep(key, step, yield* compute(job));
    } finally { // what a run that was given up had not begun to change stays known
      const left = job.start && { results: new Map([[step.path, job.start]]), iterations: 0 };
      if (start && left) cache.put(start.key, left, new Set());
    }
    if (goesOn) cache.noteProgress(step.path, unfinished, key, step.repeat);
    return made;
  };

  /** Return the same step after fewer iterations, and the key that has it: what is known, or a copy where a
   *  pass or a run reads that.
   *  @param {Step} step @param {string} unfinished */
  const earlier = (step, unfinished) => {
    const key = cache.earlier(step.path, unfinished, step.repeat);
    if (!key) return null;
    const isRead = cache.isPinned(key) || [...keys.raw.values()].includes(key);
    if (!isRead) return { key, result: cache.take(key) };
    const [found] = /** @type {Cached} */ (cache.peek(key)).results.values();
    const made = textures.take(step.size, step.kernel.outputs, isTall(step));
    for (const [name, texture] of made.textures) {
      const from = found.textures.get(name);
      if (from) kernels.copy(textures.targetOf(texture), texture.size, from);
    }
    made.iterations = found.iterations;
    made.settled = found.settled;
    return { key, result: made };
  };

  /** @param {Step} step @returns {Job["tall"]} */
  const isTall = (step) => (name) => tall.has(`${step.path}:${name}`);

  /** @param {Step} step @param {Map<string, Wired | null>} inputs @param {Job["around"]} loops
   *  @param {Result | null} start @returns {Job} */
  const jobOf = (step, inputs, loops, start) => {
    const text = around.text(step.kernel);
    return {
      step, text, inputs, around: loops, start, tall: isTall(step), samples: around.samples(step),
      given: around.given(step, loops ? loops.frame : null), keepsSurface: continued.has(step.path),
      time: plan.time, rows: (width, height) => around.rows(text, width, height),
    };
  };

  /** @param {Job} job @returns {Working<Result>} */
  const compute = function* (job) {
    const { step, inputs, around: loops } = job, { kind } = step.kernel;
    ran.push(step.path);
    if (kind === "source") return fromData(step, loops);
    if (kind === "draw") yield* withSamples(step, inputs);
    const runner = kind === "draw" ? draws : kind === "plain_fragment" ? plain : kernels;
    return yield* runner.run(job);
  };

  /** Draw again what a draw goes on from, where its samples went on into an earlier run of this draw.
   *  @param {Step} step @param {Map<string, Wired | null>} inputs @returns {Working<void>} */
  const withSamples = function* (step, inputs) {
    const wired = inputs.get("initial"), path = wired ? pathOf(wired.result) : "";
    const owner = wired && (wired.result.of || wired.result), earlier = steps.get(path);
    if (!wired || !owner || owner.surface || !earlier || !isSize(owner.size, step.size)) return;
    /** @type {Map<string, Wired | null>} */
    const again = new Map();
    for (const [name, source] of earlier.inputs) again.set(name, wiredTo(source, new Map()));
    const made = yield* compute(jobOf(earlier, again, null, null));
    owner.surface = made.surface;
    made.surface = null;
    textures.give(made);
  };

  /** Return a source's texels, which the page carries. @param {Step} step @param {Job["around"]} loops */
  const fromData = (step, loops) => {
    const result = textures.take(step.size, step.kernel.outputs, isTall(step));
    for (const { output, format, blob } of around.given(step, loops ? loops.frame : null).moment) {
      const texture = result.textures.get(output);
      if (texture) textures.write(texture, texelsOf(gl, textures.formats(format), images.blob(blob)));
    }
    return result;
  };

  /** @param {Source | null | undefined} source @param {Fed} fed @returns {Wired | null} */
  const wiredTo = (source, fed) => {
    if (!source) return null;
    if ("loop" in source) return fed.get(`${source.loop} ${source.name}`) || null;
    const result = /** @type {Result} */ (results.get(source.path));
    const texture = result.textures.get(source.output);
    return texture ? { result, texture, output: source.output } : null;
  };

  // ── loops ──

  /** Run a loop from the iteration that is known, or from an earlier one where that lies further on.
   *  @param {LoopStep} loop @returns {Working<void>} */
  const runCachedLoop = function* (loop) {
    const key = /** @type {string} */ (keys.loops.get(loop.path));
    let state = cache.get(key, used);
    if (!state) state = cache.put(key, { results: new Map(), iterations: 0 }, used);
    if (state.cancel) state.cancel();
    state.cancel = around.cancel;
    const taken = goBack(loop, key, state);
    let ended = false;
    try {
      yield* runLoop(loop, state, new Map(), new Map(), null);
      ended = true;
    } finally {
      state.cancel = null;
      const isOnlyFed = taken > 0 && state.iterations === taken; // what a loop feeds back, and no more
      if (!ended && isOnlyFed) setAside(loop, key, state);
    }
  };

  /** Set a loop back where it is too far, or on to a later state that was kept; return the iterations of
   *  that.
   *  @param {LoopStep} loop @param {string} key @param {Cached} state */
  const goBack = (loop, key, state) => {
    if (state.iterations === loop.repeat) return 0;
    const latest = cache.states.latest(loop.path, key, loop.repeat - 1);
    if (latest <= state.iterations && state.iterations < loop.repeat) return 0;
    setAside(loop, key, state);
    if (latest) {
      state.results = cache.states.take(loop.path, key, latest);
      state.iterations = latest;
    }
    return latest;
  };

  /** Keep what a state of a loop that follows the time feeds back, release the rest, and empty it.
   *  @param {LoopStep} loop @param {string} key @param {Cached} state */
  const setAside = (loop, key, state) => {
    if (state.iterations && loop.followsTime) {
      const fed = new Map();
      for (const [, , { path }] of loop.feedback) {
        const result = state.results.get(path);
        if (result) fed.set(path, result);
        state.results.delete(path);
      }
      cache.states.keep(loop.path, key, state.iterations, fed, loop.repeat);
    }
    release(state.results);
    state.results = new Map();
    state.iterations = 0;
  };

  /** @param {Map<string, Result>} made */
  const release = (made) => made.forEach(textures.give);

  /** Run a loop's iterations after `state`, which each replaces; what changes with a loop around it only goes
   *  into `owned`; `frame` is that of the loop around it that counts frames.
   *  @param {LoopStep} loop @param {Cached} state @param {Fed} outer @param {Map<string, Result>} owned
   *  @param {number | null} frame @returns {Working<void>} */
  const runLoop = function* (loop, state, outer, owned, frame) {
    yield* run(loop.body);
    const fed = new Map(outer);
    const inside = new Map(stepsOf(bodyOf(loop, 0)).map((step) => [step.path, step]));
    for (const [name, first, ref] of loop.feedback) {
      const own = `${loop.path} ${name}`;
      fed.set(own, wiredTo(first, outer));
      const from = first && "loop" in first ? fedFrom.get(`${first.loop} ${first.name}`) : undefined;
      fedFrom.set(own, from || [/** @type {Step} */ (inside.get(ref.path)), ref.output]);
    }
    const changingOf = (/** @type {number} */ iteration) =>
      bodyOf(loop, iteration).filter((node) => changesOf(node).has(loop.path));
    for (const node of bodyOf(loop, 0)) {
      if (changesOf(node).has(loop.path)) continue;
      yield* runInside(node, outer, { number: 0, total: 0, frame }, owned);
    }
    if (!loop.repeat && !state.results.size) state.results = initial(loop, changingOf(0), fed);
    state.results.forEach((result, path) => results.set(path, result));
    for (let iteration = state.iterations; iteration < loop.repeat; iteration++) {
      if (iteration) {
        for (const [name, , ref] of loop.feedback) fed.set(`${loop.path} ${name}`, wiredTo(ref, fed));
      }
      const at = { number: iteration, total: loop.total, frame: loop.countsFrames ? iteration : frame };
      /** @type {Map<string, Result>} */
      let made = new Map();
      try {
        for (const node of changingOf(iteration)) yield* runInside(node, fed, at, made);
        if (changesOf(loop).size) release(state.results);
        else setAside(loop, /** @type {string} */ (keys.loops.get(loop.path)), state);
        state.results = made;
        state.iterations = iteration + 1;
        made = new Map();
      } finally {
        release(made);
        for (const [name] of loop.feedback) {
          const empty = zeros.get(`${loop.path} ${name}`);
          if (empty) textures.give(empty);
          zeros.delete(`${loop.path} ${name}`);
        }
      }
    }
  };

  /** Run a node of a loop's body; what the cache does not hold goes into `owned`.
   *  @param {PlanNode} node @param {Fed} fed @param {NonNullable<Job["around"]>} at
   *  @param {Map<string, Result>} owned @returns {Working<void>} */
  const runInside = function* (node, fed, at, owned) {
    if (!changesOf(node).size) {
      yield* runOnce(node);
      return;
    }
    if (isLoop(node)) {
      /** @type {Cached} */
      const state = { results: new Map(), iterations: 0 };
      try {
        yield* runLoop(node, state, fed, owned, at.frame);
      } finally {
        state.results.forEach((result, path) => owned.set(path, result));
      }
      return;
    }
    const inputs = new Map(node.inputs.map(([name, source]) => [name, inputOf(node, name, source, fed)]));
    const job = jobOf(node, inputs, at, null), made = yield* compute(job);
    around.computed?.(job, made);
    owned.set(node.path, made);
    results.set(node.path, made);
  };

  /** Return what an input reads; of what is fed back, before the first iteration, perhaps zeros.
   *  @param {Step} step @param {string} name @param {Source | null} source @param {Fed} fed
   *  @returns {Wired | null} */
  const inputOf = (step, name, source, fed) => {
    const found = wiredTo(source, fed);
    if (found || !source || !("loop" in source)) return found;
    const declared = step.kernel.inputs.find((each) => each.name === name);
    if (!declared || !(step.kernel.dialect || declared.fallback === "zero")) return null;
    const key = `${source.loop} ${source.name}`;
    const [origin, output] = /** @type {[Step, string]} */ (fedFrom.get(key));
    const result = zeros.get(key) || kernels.empty(origin, isTall(origin));
    zeros.set(key, result);
    return { result, texture: /** @type {any} */ (result.textures.get(output)), output };
  };

  /** Return what a loop gives before its first iteration: what that would read, else zeros.
   *  @param {LoopStep} loop @param {PlanNode[]} changing @param {Fed} fed */
  const initial = (loop, changing, fed) => {
    const found = new Map(stepsOf(changing).map((step) => [step.path, kernels.empty(step, isTall(step))]));
    for (const [name, , ref] of loop.feedback) {
      const wired = fed.get(`${loop.path} ${name}`), texture = found.get(ref.path)?.textures.get(ref.output);
      if (wired && texture) kernels.copy(textures.targetOf(texture), texture.size, wired.texture);
    }
    return found;
  };

  /** Run all; what is in use stays known until the end. @returns {Working<void>} */
  const all = function* () {
    cache.pinned.add(used);
    try {
      yield* run(nodes);
    } finally {
      cache.pinned.delete(used);
      cache.trim();
    }
  };

  return {
    ran, all,

    /** Return what a step outside of loops is run with. @param {Step} step @returns {Job} */
    job: (step) =>
      jobOf(
        step, new Map(step.inputs.map(([name, source]) => [name, wiredTo(source, new Map())])), null, null,
      ),

    /** Return what a pass has computed. @param {string} path @returns {Result} */
    result: (path) => /** @type {Result} */ (results.get(path)),

    /** Return a texture of a pass, if that has run. @param {Ref} ref */
    known: (ref) => (results.has(ref.path) ? wiredTo(ref, new Map()) : null),

    /** Return a texture of a pass that has run. @param {Ref} ref @returns {Wired} */
    texture: (ref) => {
      const wired = results.has(ref.path) ? wiredTo(ref, new Map()) : null;
      if (!wired) throw failure("sketch", `There is no texture '${ref.path}:${ref.output}'.`);
      return wired;
    },
  };
};
