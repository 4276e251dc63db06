// plain.js -- plain shaders, other tools' among them: what they are given, the shapes of their textures.

import { PLAIN } from "./binder.js";
import { unitVector } from "./camera.js";
import { failure } from "./context.js";
import { stepsOf } from "./plan_nodes.js";
import { setUniform } from "./programs.js";

/** @import { Job } from "./kernels.js"
 *  @import { Plan } from "./plan.js"
 *  @import { Step } from "./plan_nodes.js"
 *  @import { Sampling } from "./schema.js"
 *  @import { Texture } from "./textures.js" */

// ── Copies textures of two dimensions into cubes, volumes, arrays and lines: engine/textures.py.
//
// WebGL has no textures of one dimension: a line is one row, which the text reads at its middle.

const FACES = 6;

/** What size a texture of a shape should have, "" where `size` is one.
 *  @param {string} shape @param {[number, number]} size */
function misfit(shape, [width, height]) {
  if (shape === "cube" && height !== FACES * width) {
    return `a cube map is six faces above each other, 1 : 6, as ${width} x ${FACES * width}`;
  }
  if (shape === "volume" && height !== width * width) {
    return `a volume of n texels a side is n slices above each other, as ${width} x ${width * width}`;
  }
  if (shape === "layers" && height % width) {
    const tall = Math.max(Math.floor(height / width), 1) * width;
    return `an array is square layers above each other, as ${width} x ${tall}`;
  }
  return "";
}

/** A shape's own size in texels, by the size of the texture that holds it.
 *  @param {string} shape @param {[number, number]} size @returns {[number, number, number]} */
function shapedSize(shape, [width, height]) {
  if (!shape) return [width, height, 1];
  const deep = shape === "volume" ? width : shape === "layers" ? Math.floor(height / width) : 1;
  return [width, shape === "line" ? 1 : width, deep];
}

/** @param {import("./context.js").Context} context @param {import("./textures.js").Textures} textures */
const createShapes = ({ gl, make, limits }, textures) => {
  /** @type {Object<string, number>} */
  const targets = {
    cube: gl.TEXTURE_CUBE_MAP, volume: gl.TEXTURE_3D, layers: gl.TEXTURE_2D_ARRAY, line: gl.TEXTURE_2D,
  };
  /** The target of WebGL that a shape is bound to. @param {string} shape */
  const targetOf = (shape) => targets[shape] ?? gl.TEXTURE_2D;

  /** A copy of a texture in another shape, which is the caller's.
   *  @param {string} shape @param {Texture} source @param {boolean} levels
   *  @param {string} name what it is read as, for messages @returns {Texture} */
  const copied = (shape, source, levels, name) => {
    const wrong = misfit(shape, source.size);
    if (wrong) throw failure("sketch", `${name} reads ${source.size.join(" x ")} texels; ${wrong}`);
    const target = targetOf(shape), [width, height, deep] = shapedSize(shape, source.size);
    const { internal, bytes } = textures.formats(source.format), texture = make("Texture");
    const longest = Math.max(width, height, shape === "volume" ? deep : 1);
    const many = levels ? 1 + Math.floor(Math.log2(longest)) : 1;
    const solid = shape === "volume" || shape === "layers";
    gl.activeTexture(gl.TEXTURE0 + limits.spare);
    gl.bindTexture(target, texture);
    if (solid) gl.texStorage3D(target, many, internal, width, height, deep);
    else gl.texStorage2D(target, many, internal, width, height);
    gl.bindFramebuffer(gl.FRAMEBUFFER, textures.targetOf(source));
    for (let part = 0; part < (shape === "cube" ? FACES : deep); part++) {
      const from = part * height;
      const face = shape === "cube" ? gl.TEXTURE_CUBE_MAP_POSITIVE_X + part : target;
      if (solid) gl.copyTexSubImage3D(target, 0, 0, 0, part, 0, from, width, height);
      else gl.copyTexSubImage2D(face, 0, 0, 0, 0, from, width, height);
    }
    if (many > 1) gl.generateMipmap(target);
    gl.bindTexture(target, null);
    const texels = source.size[0] * source.size[1] * bytes;
    return {
      texture, size: source.size, format: source.format, levels: many,
      bytes: many > 1 ? Math.ceil((texels * 4) / 3) : texels, target: null,
    };
  };

  return { copied, targetOf };
};

// ── What other tools' shaders are given by their own names: Runner._usual of engine/runner.py.

/** What only somebody at the page has; without them all is at rest. Pixels from the lower left.
 *  @typedef {object} Live
 *  @property {number[]} [mouse]   the pointer, then where it was pressed
 *  @property {number[]} [hover]   the pointer, pressed or not
 *  @property {number[]} [drag]    as ShaderToy's iMouse
 *  @property {number} [delta]     seconds since the last picture
 *  @property {number[]} [date]    year, month from 0, day, seconds */

const FRAME_RATE = 60;
const TEMPO = 2; // beats a second, of a sound that is not there
const IDENTITY = (/** @type {number} */ side) =>
  Array.from({ length: side * side }, (_, at) => (at % (side + 1) ? 0 : 1));

/** What never changes, by meaning: NEUTRAL of shader/reserved_names.py.
 *  @type {Object<string, number[]>} */
const NEUTRAL = {
  frame_rate: [60], sample_rate: [44100], forward: [0, 0, 1], none: [0], one: [1, 1, 1, 1],
  identity3: IDENTITY(3), identity4: IDENTITY(4),
};

/** How strong low, middle and high tones are at a time [s], each from 0 to 1: data/media.py.
 *  @param {number} time */
function bandsAt(time) {
  const since = (time * TEMPO) % 1;
  const [middle, high] = [3, 1.3].map((seconds) => 0.5 + 0.4 * Math.sin((2 * Math.PI * time) / seconds));
  return [Math.exp(-4 * (since < 0 ? since + 1 : since)), middle, high];
}

/** The place of the camera, and the unit vector towards the sun, of a sketch that has them.
 *  @param {Plan} plan */
function sceneOf(plan) {
  const steps = stepsOf(plan.nodes), { forward } = NEUTRAL;
  const directions = steps.flatMap((step) => step.kernel.parameters
    .filter((one) => one.widget === "direction")
    .map((one) => ({ name: one.name, value: step.values[one.name] })));
  const sun = directions.find(({ name }) => name === "sun") ?? directions[0];
  const drawn = steps.some((step) => step.kernel.kind === "draw");
  const light = sun ? unitVector(/** @type {[number, number]} */ (sun.value)) : forward;
  return { camera: drawn ? [...plan.eye.eye] : forward, light };
}

/** What the usual uniforms of a plain shader are given, by meaning: those that its text names.
 *  @param {Plan} plan @param {Step} step @param {number | null} frame of the loop around it that counts them
 *  @param {Live} live @returns {Object<string, number[]>} */
export function usualOf(plan, step, frame, live) {
  const [width, height] = step.size, time = frame === null ? plan.time : frame / FRAME_RATE;
  const { mouse = [0, 0, 0, 0], hover = [0, 0], drag = [0, 0, 0, 0], date = [1970, 0, 1, 0] } = live;
  const shown = Math.floor(FRAME_RATE * time + 1e-6);
  /** @type {Object<string, number[]>} */
  const known = {
    time: [time], resolution: [width, height, 1], square_resolution: [width, width, 1],
    buttons: [drag[2] > 0 ? 1 : 0, 0, 0, 0], mouse, drag, hover,
    hover_share: [hover[0] / width, hover[1] / height],
    delta: [frame === null ? live.delta ?? 1 / FRAME_RATE : 1 / FRAME_RATE],
    date, date_from_1: [date[0], date[1] + 1, ...date.slice(2)],
    frame: [shown], frame_of_time: [shown], bands: bandsAt(time), ...NEUTRAL,
  };
  const usual = step.kernel.usual ?? [], meanings = usual.map(([, meaning]) => meaning);
  const scene = meanings.some((meaning) => meaning === "camera" || meaning === "light") ? sceneOf(plan) : {};
  const all = { ...known, ...scene };
  return Object.fromEntries(meanings.filter((meaning) => meaning in all).map((meaning) => {
    return [meaning, all[/** @type {keyof typeof all} */ (meaning)]];
  }));
}

// ── Runs plain shaders, other tools' among them: a triangle over the whole picture, once.
//
// What their uniforms get is theirs by name; a sampler that nothing feeds reads black.

const MAX_LEVELS = 12; // of a pyramid of another tool
const VALUE = "value: ", DEPTH = "depth: ", SIZES = "sizes: ";

/** The shapes of samplers and the components of other uniforms, by WebGL's number of the type.
 *  @type {Object<number, string>} */
const SHAPES = { 0x8b5e: "", 0x8b5f: "volume", 0x8b60: "cube", 0x8dc1: "layers" };
/** @type {Object<number, number>} */
const COMPONENTS = {
  0x8b50: 2, 0x8b51: 3, 0x8b52: 4, 0x8b53: 2, 0x8b54: 3, 0x8b55: 4, 0x8b57: 2, 0x8b58: 3, 0x8b59: 4,
  0x8dc6: 2, 0x8dc7: 3, 0x8dc8: 4, 0x8b5a: 4, 0x8b5b: 9, 0x8b5c: 16,
};
const isFloat = (/** @type {number} */ type) => type === 0x1406 || (type >= 0x8b50 && type <= 0x8b52)
  || (type >= 0x8b5a && type <= 0x8b5c);

/** @param {import("./context.js").Context} context @param {import("./textures.js").Textures} textures
 *  @param {import("./textures.js").Images} images @param {import("./binder.js").Binder} binder
 *  @param {import("./kernels.js").Kernels} kernels */
export const createPlain = (context, textures, images, binder, kernels) => {
  const { gl } = context, shapes = createShapes(context, textures);
  /** @type {Map<string, Texture>} */
  const constants = new Map();

  /** A texture of a shape, one texel a side. @param {string} name @param {string} shape */
  const constant = (name, shape) => {
    const flat = binder.constant(name);
    if (!shape || shape === "line") return flat;
    const key = `${name} ${shape}`, known = constants.get(key);
    if (known) return known;
    const size = /** @type {[number, number]} */ ([1, shape === "cube" ? 6 : 1]);
    const source = textures.texture(size, "rgba8");
    kernels.copy(textures.targetOf(source), size, flat);
    const made = shapes.copied(shape, source, false, name);
    textures.release(source);
    constants.set(key, made);
    return made;
  };

  /** What an input reads in its own shape, and the size of that; the copy belongs to what it is of.
   *  @param {import("./schema.js").Input} input @param {Job} job @param {Map<string, Texture>} reads
   *  @returns {{texture: Texture, size: [number, number, number]}} */
  const shaped = ({ name, shape, fallback, sampling }, { inputs, step }, reads) => {
    const wired = inputs.get(name);
    if (!wired) return { texture: constant(fallback || "black", shape), size: [1, 1, 1] };
    const size = shapedSize(shape, wired.texture.size);
    if (!shape) return { texture: reads.get(name) ?? wired.texture, size };
    const { copies } = wired.result, key = `${wired.output} ${shape} ${sampling.mipmap}`;
    let texture = copies.get(key);
    if (!texture) {
      const called = `pass '${step.path}': ${name}`;
      copies.set(key, (texture = shapes.copied(shape, wired.texture, sampling.mipmap, called)));
    }
    return { texture, size };
  };

  /** Bind a texture to a unit; return the next one.
   *  @param {number} unit @param {Texture} texture @param {string} shape @param {Sampling} sampling */
  const bind = (unit, texture, shape, sampling) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(shapes.targetOf(shape), texture.texture);
    gl.bindSampler(unit, binder.samplerOf(sampling, binder.isUnfiltered(texture)));
    return unit + 1;
  };

  /** What a uniform is given whose meaning depends on its own step.
   *  @param {string} meaning @param {Job} job @param {Map<string, number[]>} sizes [texels] of samplers */
  const numbersOf = (meaning, { step, around }, sizes) => {
    if (meaning.startsWith(VALUE)) return [Number(meaning.slice(VALUE.length))];
    if (meaning.startsWith(DEPTH)) {
      const halved = Number(meaning.slice(DEPTH.length)), digits = 32 - Math.clz32(Math.min(...step.size));
      return [Math.min(Math.max(digits + halved - 2, 0), MAX_LEVELS)];
    }
    if (meaning === "iteration") return [around ? around.number : 0];
    if (meaning === "iterations") return [around ? around.total : 1];
    const named = meaning.replace(SIZES, "").split(" ").filter(Boolean);
    return named.flatMap((name) => sizes.get(name) ?? [0, 0, 0]);
  };

  /** Set as many numbers as a uniform has, in its own kind of number; an array's elements in turn, of which
   *  there are three numbers each, or one for all of them.
   *  @param {import("./programs.js").Program} program @param {string} name @param {number[]} numbers */
  const setFitting = (program, name, numbers) => {
    const { type, length } = /** @type {import("./programs.js").Uniform} */ (program.uniforms.get(name));
    const count = COMPONENTS[type] ?? 1, all = [];
    for (let index = 0; index < length; index++) {
      const own = length > 1 && numbers.length > 1 ? numbers.slice(3 * index, 3 * index + 3) : numbers;
      for (let at = 0; at < count; at++) all.push(isFloat(type) ? own[at] ?? 0 : Math.trunc(own[at] ?? 0));
    }
    setUniform(gl, program, name, count * length === 1 ? all[0] : all);
  };

  /** Set all that a plain shader is given.
   *  @param {import("./programs.js").Program} program @param {Job} job */
  const prepare = (program, job) => {
    const { step, text, given } = job, { kernel } = step, reads = kernels.readsOf(job), inputs = new Map();
    for (const input of kernel.inputs) inputs.set(input.name, { ...shaped(input, job, reads), input });
    /** @type {Map<string, number[]>} */
    const sizes = new Map();
    /** @type {Set<string>} */
    const fed = new Set();
    let unit = 0;
    gl.useProgram(program.program);
    for (const [name, value] of text.own) setUniform(gl, program, name, value);
    for (const { name, widget, sampling = PLAIN, type } of kernel.parameters) {
      if (type === "sampler2D") fed.add(name);
      const value = step.values[name];
      if (widget !== "file") setUniform(gl, program, name, given[`pressed ${name}`] ?? value);
      else {
        const texture = images.get(String(value), sampling);
        sizes.set(name, [...texture.size, 1]);
        if (program.uniforms.has(name)) unit = binder.texture(program, name, unit, texture, sampling);
      }
    }
    for (const [name, { texture, size, input }] of inputs) {
      fed.add(name);
      sizes.set(name, size);
      if (!program.uniforms.has(name)) continue;
      setUniform(gl, program, name, unit);
      unit = bind(unit, texture, input.shape, input.sampling);
    }
    setUniform(gl, program, "k_window", [0, 0]);
    setUniform(gl, program, "k_part", [0, 0, 1, 1]);
    for (const [name, meaning] of kernel.usual ?? []) {
      if (!program.uniforms.has(name)) continue;
      setFitting(program, name, given[meaning] ?? numbersOf(meaning, job, sizes));
    }
    for (const [name, { type, length }] of program.uniforms) {
      if (fed.has(name) || !(type in SHAPES)) continue;
      // A channel that nothing feeds, or several: two kinds of samplers may not share a unit, used or not.
      setUniform(gl, program, name, length === 1 ? unit : Array.from({ length }, (_, at) => unit + at));
      for (let at = 0; at < length; at++) {
        const element = length > 1 ? inputs.get(`${name}_${at}`) : undefined;
        const texture = element ? element.texture : constant("black", SHAPES[type]);
        unit = bind(unit, texture, SHAPES[type], element ? element.input.sampling : PLAIN);
      }
    }
  };

  /** Run a plain shader; the result is the caller's.
   *  @param {Job} job @returns {import("./kernels.js").Work} */
  const run = function* (job) {
    const { step, text } = job, { kernel } = step;
    const program = kernels.programOf(job), result = kernels.empty(step, job.tall);
    prepare(program, job);
    textures.drawTo(result);
    gl.viewport(0, 0, ...step.size);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLES, 0, kernel.vertex.file ? 6 : 3);
    yield { step, text, texels: step.size[0] * step.size[1] };
    return result;
  };

  const clear = () => {
    constants.forEach(textures.release);
    constants.clear();
  };

  return { run, prepare, clear };
};
