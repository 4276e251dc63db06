// plain.js -- runs plain shaders, other tools' among them: a triangle over the whole picture, once.
//
// What their uniforms get is theirs by name (usual.js); a sampler that nothing feeds reads black.

import { PLAIN } from "./binder.js";
import { setUniform } from "./programs.js";
import { createShapes, shapedSize } from "./shapes.js";

/** @typedef {import("./textures.js").Texture} Texture */
/** @typedef {import("./kernels.js").Job} Job */
/** @typedef {import("./schema.js").Sampling} Sampling */

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
 *  @param {import("./images.js").Images} images @param {import("./binder.js").Binder} binder
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

  /** Run a plain shader; the result is the caller's.
   *  @param {Job} job @returns {import("./kernels.js").Work} */
  const run = function* (job) {
    const { step, text, given } = job, { kernel } = step;
    const program = kernels.programOf(job), reads = kernels.readsOf(job), inputs = new Map();
    for (const input of kernel.inputs) inputs.set(input.name, { ...shaped(input, job, reads), input });
    const result = kernels.empty(step, job.tall);
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

  return { run, clear };
};
