// player.js -- one sketch in an engine: its state, its picture, its texts.

import { needed as addOn } from "./addons.js";
import { failure } from "./context.js";
import { readTexture } from "./draws.js";
import { createExecution } from "./execution.js";
import { createEyeHeight } from "./eye_height.js";
import { readKernel } from "./kernel_texts.js";
import { makePlan } from "./plan.js";
import { isLoop, needed, stepsOf } from "./plan_nodes.js";
import { blobAt, playingOf } from "./recordings.js";
import { keysOf } from "./staleness.js";
import { PLAIN } from "./binder.js";

/** @typedef {import("./plan.js").Plan} Plan */
/** @typedef {import("./plan_nodes.js").Step} Step */
/** @typedef {import("./schema.js").Kernel} Kernel */
/** @typedef {import("./kernel_texts.js").KernelText} KernelText */
/** @typedef {{path: string, output: string}} Ref */
/** @typedef {ReturnType<typeof createExecution>} Execution */

/** @typedef {object} Player
 *  @property {import("./schema.js").Sketch} sketch
 *  @property {import("./schema.js").Shared} shared
 *  @property {import("./requests.js").State} state   may be changed at any time
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
 *  @property {(file: string, text: string) => Promise<import("./edits.js").Edit>} edit
 *  @property {() => import("./programs.js").Program[]} programs   that it may need again
 *  @property {() => void} forget                    what lived in a context that was lost
 *  @property {() => void} close */

const SLICE = 12; // [ms]
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
      if (kernel.kind === "plain_fragment") return addOn("plain").usualOf(plan, step, frame, live);
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
   *  @param {() => void} stop */
  const executed = function* (plan, ref, budget, stop) {
    const keys = keysFor(plan), { parts, clock } = engine;
    const execution = createExecution(plan, needed(plan.nodes, ref), {
      keys, ...parts, gl: parts.context.gl, given: givenBy(plan), text: textOf, samples: samplesOf,
      rows: (text, width, height) => clock.rows(text, width, height, budget), cancel: stop,
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

    edit: async (file, text) => {
      const texts = { ...player.texts, [file]: text };
      const { kernels, ...found } = await addOn("edits").tried(engine, sketch.kernels, textOf, texts);
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
