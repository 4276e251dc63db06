// player.js -- one sketch in an engine: its state, its picture, its texts.

import { PLAIN } from "./binder.js";
import { createCache } from "./cache.js";
import { failure } from "./context.js";
import { readTexture } from "./draws.js";
import { tried } from "./edits.js";
import { createExecution } from "./execution.js";
import { readKernel } from "./kernel_texts.js";
import { usualOf } from "./plain.js";
import { makePlan } from "./plan.js";
import { isLoop, needed, stepsOf } from "./plan_nodes.js";
import { keysOf } from "./staleness.js";

/** @import { KernelText } from "./kernel_texts.js"
 *  @import { Plan } from "./plan.js"
 *  @import { Step } from "./plan_nodes.js"
 *  @import { Camera, DataTexture, Kernel } from "./schema.js" */

// ── Which exported frame of a film or a sound shows at a time: engine/time_sources.py.

// [s] A time is meant to be that of the frame that begins so little later.
const MARGIN = 1e-6;

/** Which second of the file shows, before it loops, and whether it does.
 *  @typedef {{start: number, speed?: number, loop: boolean}} Playing */

/** Return the blob that a texture of a source has at a time in seconds; of what does not play, its own.
 *  @param {DataTexture} texture @param {Playing | null} playing @param {number} time @returns {string} */
export function blobAt(texture, playing, time) {
  const { length = 0, laps } = texture;
  if (!texture.times || !texture.frames || !playing) return texture.blob;
  let { times, frames } = texture, second = playing.start + (playing.speed ?? 1) * time + MARGIN;
  const before = second < 0 && playing.speed === undefined; // of a sound, which begins in silence
  if (playing.loop && length > 0 && !before) {
    const lead = laps ? laps.lead : 0, once = laps ? lead + length : 0; // after that nothing is new
    if (second < 0 || second >= once) second -= Math.floor((second - lead) / length) * length;
    if (laps && second >= length) ({ times, frames } = laps);
  }
  let low = 0, high = times.length; // as Python's bisect_right
  while (low < high) {
    const middle = (low + high) >> 1;
    if (second < times[middle]) high = middle;
    else low = middle + 1;
  }
  return frames[Math.max(low - 1, 0)];
}

/** Return how a source plays its file; null of one that plays none.
 *  @param {import("./schema.js").Leaf} leaf
 *  @param {Object<string, import("./schema.js").Value>} values of its parameters, by name
 *  @returns {Playing | null} */
function playingOf({ clock, values: paths }, values) {
  if (!clock) return null;
  const byPath = new Map(Object.entries(paths).map(([name, path]) => [path, values[name]]));
  const speed = clock.speed === undefined ? undefined : Number(byPath.get(clock.speed));
  return { start: Number(byPath.get(clock.start)), speed, loop: Boolean(byPath.get(clock.loop)) };
}

// ── Keeps the eye above the terrain: engine/eye_height.py.
//
// The terrain is what the first draw reads as its input `height`, if that draw names `relief` and the
// camera. Its
// texels are read once for each place of the eye; an eye outside the terrain is left where it is.

/** @typedef {{path: string, output: string}} Ref */

const CLEARANCE = 0.002; // above the ground, as a share of the eye's distance from its target
const MAX_ELEVATION = 89; // degrees of elevation, at most

/** @param {(kernel: import("./schema.js").Kernel) => Set<string>} namesOf the names in a kernel's text */
const createEyeHeight = (namesOf) => {
  let raisedBy = 0, terrainKey = "", read = "", height = 0;

  /** @param {Plan} plan @returns {Ref | null} */
  const terrainOf = (plan) => {
    for (const { kernel, inputs } of stepsOf(plan.nodes)) {
      const source = kernel.kind === "draw" && inputs.find(([name]) => name === "height")?.[1];
      if (!source || !("path" in source)) continue;
      const names = namesOf(kernel);
      if (names.has("relief") && names.has("clip_from_world")) return source;
    }
    return null;
  };

  /** Return where the eye is above the terrain, in shares of its sides; null outside it.
   *  @param {Plan} plan */
  const placeOf = ({ eye, terrain }) => {
    const [x, y] = [0, 1].map((axis) => eye.eye[axis] / terrain.extent[axis]);
    return x >= 0 && x <= 1 && y >= 0 && y <= 1 ? [x, y] : null;
  };

  /** Return a camera over the height that was read; null where the plan's own eye may stay.
   *  @param {Plan} plan @returns {Camera | null} */
  const over = (plan) => {
    const [x, y, z] = plan.eye.eye, lowest = height * plan.terrain.relief + CLEARANCE * plan.eye.distance;
    raisedBy = 0;
    if (!(z < lowest)) return null;
    raisedBy = lowest - z;
    const { target } = plan.eye, [east, north, up] = [x, y, lowest].map((side, axis) => side - target[axis]);
    const level = Math.hypot(east, north), degrees = 180 / Math.PI;
    return {
      ...plan.camera,
      azimuth: level > 0 ? Math.atan2(east, north) * degrees : plan.camera.azimuth,
      elevation: Math.min(Math.atan2(up, level) * degrees, MAX_ELEVATION),
      distance: Math.hypot(level, up),
      target: /** @type {[number, number, number]} */ ([...target]),
    };
  };

  return {
    /** By how many metres the last picture's eye was raised; 0: it was above the terrain. */
    get raisedBy() { return raisedBy; },

    /** Return a camera over the terrain where the last eye was raised over the same terrain, at the same
     *  place;
     *  null: the terrain must be drawn and read first.
     *  @param {Plan} plan @param {import("./staleness.js").Keys} keys */
    raisedAsBefore: (plan, keys) => {
      const source = raisedBy ? terrainOf(plan) : null, place = placeOf(plan);
      const isRead = !!source && keys.steps.get(source.path) === terrainKey && read.endsWith(` ${place}`);
      return isRead && place ? over(plan) : null;
    },

    /** Return a camera whose eye is over the terrain, or null where the plan's own is.
     *  @param {Plan} plan @param {import("./staleness.js").Keys} keys
     *  @param {(ref: Ref) => import("./binder.js").Wired | null} wired
     *  @param {(texture: import("./textures.js").Texture, corner: number[], size: number[]) => number[]}
     *  texels
     *  the first channel of a block of texels */
    raised: (plan, keys, wired, texels) => {
      const source = terrainOf(plan), place = placeOf(plan), found = source && wired(source);
      raisedBy = 0;
      if (!source || !place || !found) return null;
      const key = `${found.result.number} ${place}`;
      if (read !== key) {
        const { size } = found.texture, at = place.map((share, axis) => share * (size[axis] - 1));
        const low = at.map((all, axis) => Math.min(Math.trunc(all), Math.max(size[axis] - 2, 0)));
        const [wide, tall] = size.map((side) => Math.min(2, side));
        const block = texels(found.texture, low, [wide, tall]);
        const [p, q] = at.map((all, axis) => all - low[axis]);
        /** @param {number} i @param {number} j */
        const corner = (i, j) => block[Math.min(j, tall - 1) * wide + Math.min(i, wide - 1)];
        const [west, east] = [0, 1].map((i) => (1 - q) * corner(i, 0) + q * corner(i, 1));
        height = west * (1 - p) + east * p;
        read = key;
      }
      terrainKey = keys.steps.get(source.path) || "";
      return over(plan);
    },
  };
};

// ── One sketch in an engine

/** @typedef {ReturnType<typeof createExecution>} Execution */

/** @typedef {object} Player
 *  @property {import("./schema.js").Sketch} sketch
 *  @property {import("./schema.js").Shared} shared
 *  @property {import("./plan.js").State} state   may be changed at any time
 *  @property {Plan | null} plan                     of the last picture
 *  @property {boolean} looks                        whether that picture depends on the camera
 *  @property {number} raisedBy                      [m] by which its eye was raised out of the terrain
 *  @property {Object<string, string>} texts         edited files
 *  @property {(onProgress?: (done: number, total: number) => void) => Promise<void>} load
 *  @property {() => {ran: string[], milliseconds: number}} render
 *  @property {(budget?: number) => Promise<{ran: string[], milliseconds: number} | null>} renderSoon
 *  null: a later call has overtaken it
 *  @property {() => {milliseconds: number, isKnown: boolean}} estimate   what drawing will take
 *  @property {(context2d: CanvasRenderingContext2D | OffscreenCanvasRenderingContext2D) => void} drawTo
 *  @property {() => Uint8Array} picture             RGBA, row 0 south
 *  @property {(ref: Ref) => {size: [number, number], channels: number, data: Float32Array}} read
 *  @property {(path: string, iteration: number | null, visitor: Visitor) => Visited} visit   run a pass
 *  again, up to an iteration of its repeat or of the loop around it; null: the last
 *  @property {(file: string, text: string) => Promise<import("./edits.js").Edit>} edit
 *  @property {() => import("./programs.js").Program[]} programs   that it may need again
 *  @property {() => void} forget                    what lived in a context that was lost
 *  @property {() => void} close */

/** What is done with a pass that ran: `read` its textures, then `run` it once more; of a repeat with the
 *  textures before that iteration.
 *  @typedef {object} Visitor
 *  @property {(made: import("./textures.js").Result, step: Step) => void} read
 *  @property {(job: import("./kernels.js").Job, before: import("./textures.js").Result | null,
 *             iteration: number) => void} run */
/** @typedef {{iteration: number, total: number}} Visited */

const SLICE = 12; // [ms]
const CACHE_OF_VISIT = 256 * 2 ** 20; // bytes
const OWN = ["show", "copy.frag"]; // the engine's programs that any picture may need
const SEEN = new Set(["eye", "clip_from_world", "world_from_clip"]); // given names that the camera changes

/** @param {import("./engine.js").Engine} engine @param {import("./schema.js").Sketch} sketch
 *  @param {() => void} onClose @returns {Player} */
export const createPlayer = (engine, sketch, onClose) => {
  const { shared } = engine;
  /** @type {Map<Kernel, KernelText>} */
  let read = new Map();
  /** @type {{execution: Execution, wired: import("./binder.js").Wired} | null} the last picture */
  let shown = null;
  /** @type {(() => void) | null} ends the run that is at work in slices */
  let cancel = null;
  let number = 0; // of the runs in slices

  /** @param {Kernel} kernel @returns {KernelText} */
  const textOf = (kernel) => {
    let found = read.get(kernel);
    if (!found) read.set(kernel, (found = readKernel(shared, kernel, player.texts)));
    return found;
  };
  const eyeHeight = createEyeHeight((kernel) => textOf(kernel).flat.names);

  /** @param {Step} step */
  const samplesOf = ({ kernel }) => Math.max(kernel.samples || sketch.samples, 1);

  /** Return what the engine gives a step besides its parameters, where its text names it.
   *  @param {Plan} plan @returns {(step: Step, frame?: number | null) => Object<string, any>} */
  const givenBy = (plan) => {
    const { time, terrain, eye } = plan;
    /** @type {Object<string, any>} */
    const all = {
      time, extent: terrain.extent, relief: terrain.relief, base_elevation: terrain.base_elevation,
      eye: [...eye.eye],
      clip_from_world: [...eye.clipFromWorld], world_from_clip: [...eye.worldFromClip],
    };
    return (step, frame = null) => {
      const { kernel, leaf, size } = step;
      const now = frame === null ? time : frame / 60;
      if (kernel.kind === "source") {
        const playing = leaf ? playingOf(leaf, step.values) : null;
        return { moment: (leaf?.data ?? []).map((texture) => {
          return { output: texture.output, format: texture.format, blob: blobAt(texture, playing, now) };
        }) };
      }
      const { live = {} } = player.state;
      if (kernel.kind === "plain_fragment") return usualOf(plan, step, frame, live);
      /** @type {Object<string, any>} */
      const found = {};
      for (const name of textOf(kernel).given) {
        const { extent } = terrain;
        if (name === "spacing") found[name] = extent.map((side, i) => side / Math.max(size[i] - 1, 1));
        else if (name === "time" && frame !== null) found[name] = frame / 60;
        else if (Object.hasOwn(all, name)) found[name] = all[name];
      }
      return found;
    };
  };

  /** @param {Plan} plan */
  const keysFor = (plan) => {
    const given = givenBy(plan);
    return keysOf(plan, {
      given: (step) =>
        (step.kernel.kind === "draw" ? { ...given(step), samples: samplesOf(step) } : given(step)),
      used: (kernel) => textOf(kernel).used,
      text: (kernel) => textOf(kernel).identity,
    });
  };

  /** Run what a texture of a plan needs. @param {Plan} plan @param {Ref} ref @param {number} budget [ms]
   *  @param {() => void} stop @param {Partial<import("./execution.js").Around>} [other] than usual */
  const executed = function* (plan, ref, budget, stop, other = {}) {
    const keys = keysFor(plan), { parts, clock } = engine;
    const execution = createExecution(plan, needed(plan.nodes, ref), {
      keys, ...parts, gl: parts.context.gl, given: givenBy(plan), text: textOf, samples: samplesOf,
      rows: (text, width, height) => clock.rows(text, width, height, budget), cancel: stop, ...other,
    });
    yield* execution.all();
    return { plan, keys, execution };
  };

  /** Run what the picture needs; where the eye is under the terrain, again from just above it.
   *  @param {number} budget [ms] 0: nothing waits between pieces @param {() => void} stop */
  const pictured = function* (budget, stop) {
    const { context, textures } = engine.parts, { gl } = context;
    if (gl.isContextLost()) throw failure("context-lost", "The graphics context was lost.");
    const objects = context.objects, plan = makePlan(sketch, player.state);
    const leaves = player.state.map || sketch.aboveGround === false;
    let camera = leaves ? null : eyeHeight.raisedAsBefore(plan, keysFor(plan));
    /** @type {string[]} */
    let ran = [], found = null;
    if (!camera) {
      found = yield* executed(plan, plan.picture, budget, stop);
      ({ ran } = found.execution);
      if (!leaves) camera = eyeHeight.raised(plan, found.keys, found.execution.known, texelsOf);
    }
    if (camera) {
      const raised = makePlan(sketch, { ...player.state, camera });
      found = yield* executed(raised, raised.picture, budget, stop);
      ran = [...ran, ...found.execution.ran];
    }
    const { execution, plan: drawn } = /** @type {NonNullable<typeof found>} */ (found);
    player.plan = drawn;
    shown = { execution, wired: execution.texture(drawn.picture) };
    engine.trim();
    if (objects !== context.objects) context.check(sketch.name); // what ran without an error will do so again
    return ran;

    /** @param {import("./textures.js").Texture} texture @param {number[]} corner @param {number[]} size */
    function texelsOf(texture, [x, y], [width, height]) {
      const { type } = textures.formats(texture.format);
      const bytes = type === gl.UNSIGNED_BYTE, shorts = type === gl.UNSIGNED_SHORT;
      const all = new (bytes ? Uint8Array : shorts ? Uint16Array : Float32Array)(16);
      gl.bindFramebuffer(gl.FRAMEBUFFER, textures.targetOf(texture));
      gl.readPixels(x, y, width, height, gl.RGBA, bytes || shorts ? type : gl.FLOAT, all);
      return [0, 4, 8, 12].map((at) => all[at] / (bytes ? 255 : shorts ? 65535 : 1));
    }
  };

  /** @template T @param {Generator<any, T, any>} work */
  const drained = (work) => {
    for (;;) {
      const { value, done } = work.next();
      if (done) return /** @type {T} */ (value);
    }
  };

  const stop = () => {
    if (cancel) cancel();
    cancel = null;
  };

  const render = () => {
    stop();
    const start = performance.now(), ran = drained(pictured(0, () => {}));
    return { ran, milliseconds: performance.now() - start };
  };

  /** Return the last picture's texture; drawn anew where its texels are gone. */
  const texture = () => {
    if (!shown || shown.wired.result.gone || shown.wired.result.of?.gone) render();
    return /** @type {NonNullable<typeof shown>} */ (shown).wired.texture;
  };

  /** @type {Player} */
  const player = {
    sketch, shared, state: {}, plan: null, texts: {}, render,
    get raisedBy() { return eyeHeight.raisedBy; },
    get looks() {
      const { plan } = player;
      return !!plan && stepsOf(needed(plan.nodes, plan.picture)).some(({ kernel }) =>
        (kernel.kind === "kernel" || kernel.kind === "draw")
        && textOf(kernel).given.some((name) => SEEN.has(name)));
    },

    load: async (onProgress = () => {}) => {
      const { parts } = engine, plan = makePlan(sketch, player.state);
      await loadData(plan);
      const programs = [];
      for (const step of stepsOf(plan.nodes)) {
        if (step.kernel.kind === "source") continue;
        const program = parts.kernels.ask(textOf(step.kernel), byHandOf(plan, step));
        programs.push({ kernel: step.kernel, program });
      }
      const own = OWN.map(parts.kernels.askOwn), all = [...programs.map(({ program }) => program), ...own];
      await parts.programs.wait(all, onProgress);
      for (const { kernel, program } of programs) {
        if (program.state === "failed") throw parts.kernels.refused(textOf(kernel), program);
      }
    },

    renderSoon: async (budget = SLICE) => {
      stop();
      const own = ++number, start = performance.now();
      while (own === number) {
        let stopped = false;
        const work = pictured(budget, () => cancel?.());
        cancel = () => {
          stopped = true;
          work.return(/** @type {any} */ (undefined));
        };
        const done = await engine.clock.run(engine.parts.context.gl, work, budget, () => stopped);
        if (done) {
          cancel = null;
          return { ran: done.found, milliseconds: performance.now() - start };
        }
      }
      return null;
    },

    estimate: () => {
      const plan = makePlan(sketch, player.state), keys = keysFor(plan), { cache } = engine.parts;
      let milliseconds = 0, isKnown = true;
      /** @param {import("./plan_nodes.js").PlanNode} node @param {number} times */
      const add = (node, times) => {
        if (isLoop(node)) {
          const known = cache.peek(keys.loops.get(node.path) || ""), from = known ? known.iterations : 0;
          const left = from <= node.repeat ? node.repeat - from : node.repeat;
          if (node.bodies.length === 1) node.body.forEach((inside) => add(inside, times * left));
          else node.bodies.slice(node.repeat - left, node.repeat).forEach((body) => {
            body.forEach((inside) => add(inside, times));
          });
          return;
        }
        if (cache.peek(keys.steps.get(node.path) || "") || node.kernel.kind === "source" || !times) return;
        const text = textOf(node.kernel);
        isKnown = isKnown && engine.clock.isKnown(text);
        milliseconds += times * engine.clock.expected(text, node.size[0] * node.size[1] * node.repeat);
      };
      needed(plan.nodes, plan.picture).forEach((node) => add(node, 1));
      return { milliseconds, isKnown };
    },

    drawTo: (context2d) => {
      const { canvas, parts } = engine, source = texture(), [width, height] = source.size;
      if (canvas.width < width || canvas.height < height) {
        canvas.width = Math.max(canvas.width, width);
        canvas.height = Math.max(canvas.height, height);
      }
      parts.kernels.show(null, source);
      const { width: wide, height: tall } = context2d.canvas;
      context2d.drawImage(canvas, 0, canvas.height - height, width, height, 0, 0, wide, tall);
    },

    picture: () => {
      const { context: { gl }, textures, kernels } = engine.parts;
      const source = texture(), [width, height] = source.size;
      const made = source.format === "rgba8" ? source : textures.texture(source.size, "rgba8");
      if (made !== source) kernels.show(textures.targetOf(made), source);
      const data = new Uint8Array(4 * width * height);
      gl.bindFramebuffer(gl.FRAMEBUFFER, textures.targetOf(made));
      gl.readPixels(0, 0, width, height, gl.RGBA, gl.UNSIGNED_BYTE, data);
      if (made !== source) textures.release(made);
      return data;
    },

    read: (ref) => {
      stop();
      const plan = makePlan(sketch, { ...player.state, interpolated: false });
      const { execution } = drained(executed(plan, ref, 0, () => {})), { context, textures } = engine.parts;
      const { texture } = execution.texture(ref);
      return {
        size: texture.size, channels: textures.formats(texture.format).channels,
        data: readTexture(context, textures, texture),
      };
    },

    visit: (path, wanted, { read: look, run }) => {
      stop();
      const state = { ...player.state, map: null, interpolated: false }, whole = makePlan(sketch, state);
      const step = whole.steps.get(path), loop = whole.nodes.filter(isLoop).find((node) =>
        stepsOf([node]).some((inside) => inside.path === path));
      if (!step) throw failure("sketch", `There is no pass '${path}'.`);
      const repeats = step.kernel.kind === "kernel" && step.kernel.repeat !== 1;
      const total = loop ? loop.repeat : repeats ? step.repeat : 1;
      const ref = { path, output: step.kernel.outputs[0].name };
      if (!total) throw failure("sketch", `Pass '${path}' has not run yet.`);
      const iteration = Math.min(Math.max(wanted ?? total - 1, 0), total - 1);
      /** @param {number} count iterations after which the repeat stops */
      const upTo = (count) =>
        makePlan(sketch, { ...state, steps: { ...state.steps, [loop ? loop.path : path]: count } });
      if (loop) { // of what a loop ran for its earlier iterations nothing is left
        const { textures, kernels } = engine.parts, cache = createCache(CACHE_OF_VISIT, textures);
        drained(executed(upTo(iteration + 1), ref, 0, () => {}, { cache, computed: (job, made) => {
          if (job.step.path !== path || job.around?.number !== iteration) return;
          look(made, job.step);
          const last = job.step.repeat - 1; // of its own repeat
          if (!repeats || last < 0) return run(job, null, iteration);
          const before = drained(kernels.run({ ...job, start: null, step: { ...job.step, repeat: last } }));
          run(job, before, last);
          textures.give(before);
        } }));
        cache.clear();
      } else {
        const plan = repeats ? upTo(iteration + 1) : whole;
        const after = drained(executed(plan, ref, 0, () => {})).execution;
        look(after.result(path), step);
        const before = repeats ? drained(executed(upTo(iteration), ref, 0, () => {})).execution : after;
        run(before.job(step), repeats ? before.result(path) : null, iteration);
      }
      return { iteration, total };
    },

    edit: async (file, text) => {
      const texts = { ...player.texts, [file]: text };
      const { kernels, ...found } = await tried(engine, sketch.kernels, textOf, texts);
      if (!found.errors.length) {
        stop();
        player.texts = texts;
        for (const each of kernels) read.set(each.kernel, each);
      }
      return found;
    },

    programs: () => {
      const all = [...read.values()].flatMap((each) => [...each.programs.values()]);
      const chosen = all.flatMap((each) => [...each.chosen.values()]);
      return [...all, ...chosen.flatMap(({ program }) => program ?? [])];
    },

    forget: () => {
      stop();
      read = new Map();
      shown = null;
    },

    close: () => {
      stop();
      number++;
      shown = null;
      onClose();
    },
  };

  /** Load what a plan's sources and files carry. @param {Plan} plan */
  const loadData = async (plan) => {
    const { images } = engine.parts, waiting = [];
    for (const { kernel, leaf, values } of stepsOf(plan.nodes)) {
      for (const { blob, frames = [blob], laps } of leaf?.data || [])
        waiting.push(...[...frames, ...laps?.frames ?? []].map(images.loadBlob));
      for (const { name, widget, sampling } of kernel.parameters) {
        if (widget !== "file" || kernel.kind === "source") continue;
        waiting.push(images.load(String(values[name]), sampling || PLAIN));
      }
    }
    await Promise.all(waiting);
  };

  /** Return which inputs of a step will be filtered by hand. @param {Plan} plan @param {Step} step */
  const byHandOf = (plan, step) => {
    const { context, textures } = engine.parts, found = new Map();
    if (context.floatLinear) return found;
    for (const { name, sampling } of step.kernel.inputs) {
      const source = step.inputs.find(([input]) => input === name)?.[1];
      if (!source || !("path" in source)) continue;
      const outputs = plan.steps.get(source.path)?.kernel.outputs;
      const format = outputs?.find((each) => each.name === source.output)?.format;
      if (format && sampling.filter === "linear" && !sampling.mipmap && textures.formats(format).float32)
        found.set(name, sampling.wrap);
    }
    return found;
  };

  return player;
};
