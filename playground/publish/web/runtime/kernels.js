// kernels.js -- runs kernels: a triangle over the whole target, once for each iteration.
//
// A kernel that repeats writes two sets of textures alternately. One whose iterations fill a lattice ever
// more
// closely fills as small a part of its textures as that takes.

import { isSize, PLAIN } from "./binder.js";
import { failure } from "./context.js";
import { complaintsOf } from "./edits.js";
import { headerNames, shiftAfter, whole } from "./formulas.js";
import { stagesOf, toES } from "./kernel_texts.js";
import { setUniform } from "./programs.js";
import { roundedOutputs } from "./textures.js";

/** @import { Wired } from "./binder.js"
 *  @import { Program } from "./programs.js"
 *  @import { Result, Texture } from "./textures.js" */

// ── Programs with what is chosen written in, where a program draws: engine/kernels.py.
//
// A software renderer goes both ways of every `if`: what was not chosen costs as much as what was, unless
// its compiler can see that it never happens. A kernel that is drawn again and again with the same
// checkboxes, menus and wires gets a program of its own for them, compiled behind the one that is drawn.

const OFTEN = 3; // draws with the same choices, after which they are written in
const MAX_PROGRAMS = 8; // programs with choices that are remembered of one without

/** Write checkboxes, menus and what is wired into a stage's text as constants: no line and no column moves.
 *  @param {string} text @param {[string, number][]} choices names, whole numbers @returns {string} */
export const withChoices = (text, choices) => {
  for (const [name, value] of choices) {
    const pattern = new RegExp(`^([ \\t]*)uniform([ \\t]+(bool|int)[ \\t]+${name}\\b)[^;\\n]*;`, "gm");
    text = text.replace(pattern, (_, before, declared, type) =>
      `${before}const  ${declared} = ${type === "bool" ? Boolean(value) : value};`);
  }
  return text;
};

/** What is chosen of a step, and what of it is wired. @param {Job} job @returns {[string, number][]} */
const choicesOf = ({ step, inputs }) => {
  const { kernel, values, size } = step;
  /** @type {[string, number][]} */
  const found = [];
  for (const { name, type, widget } of kernel.parameters) {
    if ((type === "bool" && widget !== "button") || (type === "int" && widget === "menu"))
      found.push([name, Number(values[name])]);
  }
  let unwired = false;
  for (const { name, fallback } of kernel.inputs) {
    const wired = inputs.get(name);
    unwired ||= !wired && !!fallback;
    found.push([`wired_${name}`, Number(!!wired)]);
    found.push([`matches_${name}`, Number(!!wired && isSize(wired.texture.size, size))]);
  }
  return [...found, ["k_unwired", Number(unwired)]];
};

/** @param {import("./context.js").Context} context @param {import("./programs.js").Programs} programs
 *  @param {number} [often]  draws with the same choices until they are written in */
export const createChosen = ({ software, parallel }, programs, often = OFTEN) => {
  /** The program to draw a step with: the one that is given, until another is ready.
   *  @param {Job} job @param {Program} general @returns {Program} */
  const of = (job, general) => {
    if (!software || !parallel || job.step.kernel.kind === "plain_fragment") return general;
    const choices = choicesOf(job), key = choices.join(), { chosen } = general;
    const found = chosen.get(key) ?? { times: 0, program: null };
    chosen.delete(key);
    chosen.set(key, found);
    if (chosen.size > MAX_PROGRAMS) chosen.delete(/** @type {string} */ (chosen.keys().next().value));
    if (found.program?.state === "gone") found.program = null;
    if (!found.program && ++found.times < often) return general;
    found.program ??= programs.ask(texts(general, choices));
    programs.touch(found.program);
    return programs.isDone(found.program) && programs.finish(found.program) ? found.program : general;
  };

  return { of };
};

/** @param {Program} general @param {[string, number][]} choices @returns {[string, string]} */
const texts = ({ texts: [vertex, fragment] }, choices) =>
  [withChoices(vertex, choices), withChoices(fragment, choices)];

// ── Finds out whether a step of a repeat changed any texel: playground/engine/kernels.py.
//
// After n steps the next comparison is about √n steps away, since its answer is waited for.

const BLOCK = 8; // texels a side that one fragment compares
const CHANGED = [{ name: "k_changed", format: "r8" }];

/** @param {WebGL2RenderingContext} gl @param {import("./textures.js").Textures} textures
 *  @param {import("./binder.js").Binder} binder @param {() => void} fill
 *  @param {() => import("./programs.js").Program} programOf of changed.frag */
const createSettling = (gl, textures, binder, fill, programOf) => {
  /** Whether a bit of a texel differs; another framebuffer and program stay bound.
   *  @param {Result} now @param {Result} before */
  const differ = (now, before) => {
    const program = programOf();
    const size = /** @type {[number, number]} */ (now.size.map((side) => Math.ceil(side / BLOCK)));
    const target = textures.take(size, CHANGED, () => false), found = new Uint8Array(4 * size[0] * size[1]);
    gl.useProgram(program.program);
    setUniform(gl, program, "k_block", BLOCK);
    textures.drawTo(target);
    gl.viewport(0, 0, ...size);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    for (const [name, texture] of now.textures) {
      const earlier = /** @type {import("./textures.js").Texture} */ (before.textures.get(name));
      binder.texture(program, "k_now", 0, texture, PLAIN);
      binder.texture(program, "k_before", 1, earlier, PLAIN);
      fill();
    }
    gl.readPixels(0, 0, ...size, gl.RGBA, gl.UNSIGNED_BYTE, found);
    textures.give(target);
    return found.some((value, index) => value !== 0 && index % 4 === 0);
  };

  /** What watches one repeat after so many steps: it compares, or says that it need not yet.
   *  @param {number} done
   *  @returns {(done: number, now: Result, before: Result) => "" | "differ" | "settled"} */
  const watch = (done) => {
    let next = done + 2 + Math.floor(Math.sqrt(done));
    return (count, now, before) => {
      if (count < next) return "";
      next = count + 1 + Math.floor(Math.sqrt(count));
      return differ(now, before) ? "differ" : "settled";
    };
  };

  return { watch };
};

// ── Runs kernels

/** @typedef {ReturnType<typeof createKernels>} Kernels */

/** What is yielded after each piece of work: whose, and how much. What is sent back says whether others may
 *  have used the context meanwhile.
 *  @typedef {Generator<{step: import("./plan_nodes.js").Step, text: import("./kernel_texts.js").KernelText,
 *                       texels: number}, Result, boolean | undefined>} Work */

/** A step about to run, with all it reads.
 *  @typedef {object} Job
 *  @property {import("./plan_nodes.js").Step} step
 *  @property {import("./kernel_texts.js").KernelText} text
 *  @property {Object<string, any>} given
 *  @property {Map<string, Wired | null>} inputs
 *  @property {{number: number, total: number, frame: number | null} | null} around   where its loops are
 *  @property {Result | null} start            the same step after fewer iterations; null once used up
 *  @property {number} samples                 of a draw
 *  @property {boolean} keepsSurface           a later draw goes on from it
 *  @property {(name: string) => boolean} tall whether an output is read with levels
 *  @property {number} time                    of the picture
 *  @property {(width: number, height: number) => number} rows   how many of so many to draw at once */

const TRIANGLE = "#version 330\nvoid main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1)"
  + " * 4.0 - 1.0, 0.0, 1.0); }\n";
const SHOW = "#version 330\nuniform sampler2D k_picture; uniform int k_channels; out vec4 k_out;"
  + " void main() { vec4 k_all = texelFetch(k_picture, ivec2(gl_FragCoord.xy), 0);"
  + " k_all = mix(vec4(0.0), k_all, equal(k_all, k_all));"
  + " k_out = vec4(k_channels == 1 ? k_all.rrr : k_all.rgb, k_channels == 4 ? k_all.a : 1.0); }\n";
const ROWS = 64; // a band's rows are a multiple of these: no tile or quad of pixels is cut

/** @param {import("./context.js").Context} context @param {import("./textures.js").Textures} textures
 *  @param {import("./programs.js").Programs} programs @param {import("./binder.js").Binder} binder
 *  @param {import("./schema.js").Shared} shared
 *  @param {number} [often]  draws with the same choices until they are written in: kernels.js */
export const createKernels = (context, textures, programs, binder, shared, often) => {
  const { gl } = context, chosen = createChosen(context, programs, often);
  /** @type {Map<string, Program>} */
  const owns = new Map();

  /** Begin to compile a fragment shader of the engine's own. @param {string} name */
  const askOwn = (name) => {
    let found = owns.get(name);
    if (!found || found.state === "gone") {
      found = programs.ask([toES(TRIANGLE), toES(shared.own[name] || SHOW)]);
      owns.set(name, found);
    }
    return found;
  };

  /** Return a fragment shader of the engine's own. @param {string} name */
  const own = (name) => {
    const found = askOwn(name);
    if (!programs.finish(found)) throw failure("shader", `${name}: ${found.logs.join("")}${found.link}`);
    return found;
  };

  const fill = () => {
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
  };

  const settling = createSettling(gl, textures, binder, fill, () => own("changed.frag"));

  /** Fill what is bound by one of the engine's own shaders, which reads a texture.
   *  @param {string} shader @param {[number, number]} size @param {Texture} source
   *  @param {Object<string, any>} uniforms */
  const drawOwn = (shader, size, source, uniforms) => {
    const program = own(shader);
    gl.useProgram(program.program);
    binder.texture(program, "k_picture", 0, source, PLAIN);
    for (const name in uniforms) setUniform(gl, program, name, uniforms[name]);
    gl.viewport(0, 0, ...size);
    fill();
  };

  /** Fill a framebuffer with a texture, nearest texel for nearest.
   *  @param {WebGLFramebuffer | null} target @param {[number, number]} size @param {Texture} source */
  const copy = (target, size, source) => {
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    drawOwn("copy.frag", size, source, { k_size: size });
  };

  /** Return new textures, each filled from that of a result.
   *  @param {string} shader @param {Result} result @param {Object<string, any>} uniforms
   *  @param {Job["step"]["kernel"]["outputs"]} outputs @param {Job["tall"]} tall */
  const drawnOwn = (shader, result, uniforms, outputs, tall) => {
    const found = textures.take(result.size, outputs, tall);
    for (const [name, texture] of found.textures) {
      gl.bindFramebuffer(gl.FRAMEBUFFER, textures.targetOf(texture));
      drawOwn(shader, result.size, /** @type {Texture} */ (result.textures.get(name)), uniforms);
    }
    return found;
  };

  /** Return the textures of a step, all zeros. @param {Job["step"]} step @param {Job["tall"]} tall */
  const empty = (step, tall) => {
    const result = textures.take(step.size, step.kernel.outputs, tall);
    textures.drawTo(result);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT);
    return result;
  };

  /** Return a wired texture with its levels: a copy where it has none, or none that are filtered.
   *  @param {Wired} wired */
  const withLevels = ({ result, texture, output }) => {
    const byHand = binder.isUnfiltered(texture);
    if (texture.levels > 1 && !byHand) {
      if (!result.mipmapped.has(output)) textures.buildLevels(texture);
      result.mipmapped.add(output);
      return texture;
    }
    let made = result.copies.get(output);
    if (!made) {
      const format = byHand ? texture.format.replace(/32f|16$/, "16f") : texture.format;
      made = textures.texture(texture.size, format, true);
      result.copies.set(output, made);
      copy(textures.targetOf(made), made.size, texture);
      textures.buildLevels(made);
    }
    return made;
  };

  /** Return what the inputs of a step read. @param {Job} job */
  const readsOf = ({ step, inputs }) => {
    /** @type {Map<string, Texture>} */
    const found = new Map();
    for (const { name, sampling } of step.kernel.inputs) {
      const wired = inputs.get(name);
      if (wired) found.set(name, sampling.mipmap ? withLevels(wired) : wired.texture);
    }
    return found;
  };

  /** Return the program of a step as its inputs are wired. @param {Job} job */
  const programOf = (job) => {
    const { step, text, inputs } = job;
    const byHand = new Map();
    if (!context.floatLinear) for (const { name, sampling } of step.kernel.inputs) {
      const wired = inputs.get(name);
      if (wired && !sampling.mipmap && sampling.filter === "linear" && binder.isUnfiltered(wired.texture))
        byHand.set(name, sampling.wrap);
    }
    const program = ask(text, byHand);
    if (!programs.finish(program)) throw refused(text, program);
    return chosen.of(job, program);
  };

  /** @param {import("./kernel_texts.js").KernelText} text @param {Program} program */
  const refused = (text, program) => {
    const complaints = complaintsOf(text, program, shared, {});
    const [{ file, line, message }] = complaints;
    return failure("shader", `${file}:${line}: ${message}`, { complaints });
  };

  /** Begin to compile a kernel. @param {import("./kernel_texts.js").KernelText} text
   *  @param {Map<string, import("./kernel_texts.js").Wrap>} byHand @returns {Program} */
  const ask = (text, byHand) => {
    const key = [...byHand].join();
    let found = text.programs.get(key);
    if (!found || found.state === "gone") {
      const { texts } = stagesOf(text, byHand, roundedOutputs(text.kernel.outputs, textures.formats));
      text.programs.set(key, (found = programs.ask(texts)));
      text.hands.set(key, byHand);
    }
    programs.touch(found);
    return found;
  };

  /** Set a kernel's iteration: its own where it repeats, else that of the loop around it.
   *  @param {Program} program @param {Job} job @param {number} iteration @param {number} [atOnce] */
  const count = (program, { step, around }, iteration, atOnce = 1) => {
    const outer = step.kernel.repeat === 1 && around && around.total ? around : null;
    const now = outer ? outer.number : iteration;
    setUniform(gl, program, "iteration", now);
    setUniform(gl, program, "iterations", outer ? outer.total : step.total);
    setUniform(gl, program, "until", now + atOnce);
    if (step.kernel.countsFrames) setUniform(gl, program, "time", now / 60);
  };

  /** Run a kernel; the result is the caller's. @param {Job} job @returns {Work} */
  const run = function* (job) {
    const { step, start, time } = job, { kernel, size } = step;
    if (start && start.settled) {
      start.iterations = step.repeat;
      job.start = null;
      return start;
    }
    const state = initial(job);
    if (!step.repeat) return untouched(job, state);
    const program = programOf(job), reads = readsOf(job);
    let unit = binder.bind(program, job, reads);
    const atOnce = Math.max(whole(kernel.atOnce ?? 1, headerNames(step, time)), 1);
    const lattice = kernel.stride !== undefined && !state.size;
    let before = start, iteration = start ? start.iterations : 0, shift = 0;
    const watch = kernel.until ? settling.watch(iteration) : null;
    /** @type {Result | null} */
    let result = null;
    try {
      while (iteration < step.repeat) {
        const turns = Math.min(atOnce, step.repeat - iteration), was = shift;
        if (lattice) shift = shiftAfter(step, iteration, time);
        const target = result = textures.take(size, kernel.outputs, job.tall), from = before;
        const [width, height] = size.map((side) => ((side - 1) >> shift) + 1), now = iteration;
        const begin = () => {
          let next = unit;
          for (const { name } of kernel.outputs) if (program.uniforms.has(`k_previous_${name}`)) {
            const texture = from ? from.textures.get(name) : state.get(name);
            const read = texture || binder.constant("zero");
            next = binder.texture(program, `k_previous_${name}`, next, read, PLAIN);
          }
          count(program, job, now, turns);
          setUniform(gl, program, "k_previous_shift", was);
          setUniform(gl, program, "k_shift", shift);
          textures.drawTo(target);
          gl.viewport(0, 0, width, height);
        };
        begin();
        const again = () => {
          unit = binder.bind(program, job, reads);
          begin();
        };
        if (yield* filled(job, width, height, again)) unit = binder.bind(program, job, reads);
        iteration += turns;
        const found = before && watch ? watch(iteration, result, before) : "";
        if (found) unit = binder.bind(program, job, reads);
        if (before) textures.give(before);
        before = result;
        job.start = result = null;
        if (found === "settled") {
          before.settled = iteration;
          break;
        }
      }
      let done = /** @type {Result} */ (before);
      if (shift) { // each texel of the lattice goes to its place, with zeros between
        const spread = drawnOwn("spread.frag", done, { k_shift: shift }, kernel.outputs, job.tall);
        textures.give(done);
        done = spread;
      }
      before = null;
      done.iterations = step.repeat;
      return done;
    } finally {
      if (result) textures.give(result);
      if (before && before !== job.start) textures.give(before);
    }
  };

  /** Fill what is bound, in bands where it takes long; return whether others may have used the context since.
   *  @param {Job} job @param {number} width @param {number} height @param {() => void} again binds all again
   *  @returns {Generator<any, boolean, boolean | undefined>} */
  const filled = function* ({ step, text, rows }, width, height, again) {
    let paused = false;
    for (let low = 0; low < height;) {
      const many = Math.ceil(rows(width, height - low) / ROWS) * ROWS, high = Math.min(low + many, height);
      const part = high - low < height;
      if (paused) again();
      if (part) gl.enable(gl.SCISSOR_TEST);
      gl.scissor(0, low, width, high - low);
      fill();
      if (part) gl.disable(gl.SCISSOR_TEST);
      paused = !!(yield { step, text, texels: width * (high - low) });
      low = high;
    }
    return paused;
  };

  /** Return the state before the first iteration to run, by output; what is missing is zero.
   *  @param {Job} job @returns {Map<string, Texture>} */
  const initial = ({ step, inputs, start }) => {
    if (start) return new Map(start.textures);
    const found = new Map();
    for (const [input, output] of Object.entries(step.kernel.initial)) {
      const wired = inputs.get(input);
      if (!wired) continue;
      if (!isSize(wired.texture.size, step.size)) {
        const [are, is] = [wired.texture.size, step.size].map((size) => size.join(" × "));
        const message = `${input} is ${are} texels, the pass ${is}; they must agree`;
        throw failure("sketch", `pass '${step.path}': ${message}`);
      }
      found.set(output, wired.texture);
    }
    return found;
  };

  /** Return the state before the first iteration, in textures of its own.
   *  @param {Job} job @param {Map<string, Texture>} state */
  const untouched = ({ step, tall }, state) => {
    const result = empty(step, tall);
    for (const [name, texture] of result.textures) {
      const from = state.get(name);
      if (from) copy(textures.targetOf(texture), step.size, from);
    }
    return result;
  };

  /** Fill a framebuffer with a texture as a picture: one channel is grey, without a fourth it is opaque.
   *  @param {WebGLFramebuffer | null} target @param {Texture} source */
  const show = (target, source) => {
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    drawOwn("show", source.size, source, { k_channels: textures.formats(source.format).channels });
  };

  return { run, show, refused, ask, programOf, readsOf, copy, drawnOwn, empty, count, askOwn };
};
