// binder.js -- binds what a program reads: given names, parameters, textures with their samplers.

import { unitVector } from "./camera.js";
import { setUniform } from "./programs.js";

/** @import { Program } from "./programs.js"
 *  @import { Sampling } from "./schema.js"
 *  @import { Texture } from "./textures.js" */

/** What an input reads: a texture, and the result that it is part of.
 *  @typedef {{result: import("./textures.js").Result, texture: import("./textures.js").Texture,
 *             output: string}} Wired */
/** @typedef {ReturnType<typeof createBinder>} Binder */

/** @type {Object<string, number[]>} */
const CONSTANTS = { white: [255, 255, 255, 255], black: [0, 0, 0, 255], zero: [0, 0, 0, 0] };
/** @type {Sampling} */
export const PLAIN = { filter: "nearest", wrap: "clamp", mipmap: false };

/** @param {import("./context.js").Context} context @param {import("./textures.js").Textures} textures
 *  @param {import("./textures.js").Images} images */
export const createBinder = (context, textures, images) => {
  const { gl, make, drop } = context;
  /** @type {Map<string, WebGLSampler>} */
  const samplers = new Map();
  /** @type {Map<string, Texture>} */
  const constants = new Map();

  /** @param {Sampling} sampling @param {boolean} unfiltered where the shader filters, or nothing may */
  const samplerOf = ({ filter, wrap, mipmap, magnify }, unfiltered) => {
    const near = unfiltered ? "nearest" : filter, far = unfiltered ? "nearest" : magnify || filter;
    const key = `${near} ${far} ${wrap} ${mipmap}`, known = samplers.get(key);
    if (known) return known;
    const made = make("Sampler"), linear = near === "linear";
    const around = { clamp: gl.CLAMP_TO_EDGE, repeat: gl.REPEAT, mirror: gl.MIRRORED_REPEAT }[wrap];
    const levels = linear ? gl.LINEAR_MIPMAP_LINEAR : gl.NEAREST_MIPMAP_NEAREST;
    gl.samplerParameteri(made, gl.TEXTURE_WRAP_S, around);
    gl.samplerParameteri(made, gl.TEXTURE_WRAP_T, around);
    gl.samplerParameteri(made, gl.TEXTURE_WRAP_R, around);
    gl.samplerParameteri(made, gl.TEXTURE_MAG_FILTER, far === "linear" ? gl.LINEAR : gl.NEAREST);
    gl.samplerParameteri(made, gl.TEXTURE_MIN_FILTER, mipmap ? levels : linear ? gl.LINEAR : gl.NEAREST);
    if (linear && mipmap && context.anisotropy[1] > 1) gl.samplerParameterf(made, ...context.anisotropy);
    samplers.set(key, made);
    return made;
  };

  /** Whether a texture can only be filtered by hand. @param {Texture} texture */
  const isUnfiltered = (texture) => !context.floatLinear && textures.formats(texture.format).float32;

  /** @param {Program} program @param {string} name @param {number} unit @param {Texture} read
   *  @param {Sampling} sampling @returns {number} the next unit */
  const texture = (program, name, unit, read, sampling) => {
    gl.activeTexture(gl.TEXTURE0 + unit);
    gl.bindTexture(gl.TEXTURE_2D, read.texture);
    gl.bindSampler(unit, samplerOf(sampling, isUnfiltered(read)));
    setUniform(gl, program, name, unit);
    return unit + 1;
  };

  /** Return a texture of one texel. @param {string} name */
  const constant = (name) => {
    let found = constants.get(name);
    if (!found) {
      constants.set(name, (found = textures.texture([1, 1], "rgba8")));
      textures.write(found, Uint8Array.from(CONSTANTS[name]));
    }
    return found;
  };

  /** Set what is the same for all iterations of a step; return the next free texture unit.
   *  `reads` are the textures of its inputs, levels made.
   *  @param {Program} program @param {import("./kernels.js").Job} job @param {Map<string, Texture>} reads */
  const bind = (program, { step, text, given, inputs }, reads) => {
    const { kernel, values, size } = step;
    /** @param {string} name @param {any} value */
    const set = (name, value) => setUniform(gl, program, name, value);
    let unit = 0;
    gl.useProgram(program.program);
    for (const [name, value] of text.own) set(name, value);
    for (const name in given) set(name, given[name]);
    set("size", size);
    for (const { name, widget, sampling = PLAIN } of kernel.parameters) {
      const value = values[name];
      if (widget === "file") {
        const read = program.uniforms.has(name) ? images.get(String(value), sampling) : null;
        if (read) unit = texture(program, name, unit, read, sampling);
        continue;
      }
      set(name, value);
      if (widget === "direction") set(`towards_${name}`, unitVector(/** @type {[number, number]} */ (value)));
    }
    let unwired = false;
    for (const { name, sampling, fallback } of kernel.inputs) {
      const wired = inputs.get(name);
      if (!wired && fallback) unwired = true;
      set(`wired_${name}`, !!wired);
      set(`matches_${name}`, !!wired && isSize(wired.texture.size, size));
      if (program.uniforms.has(name))
        unit = texture(program, name, unit, reads.get(name) || constant(fallback || "black"), sampling);
    }
    set("k_unwired", unwired);
    return unit;
  };

  const clear = () => {
    samplers.forEach((each) => drop("Sampler", each));
    constants.forEach(textures.release);
    samplers.clear();
    constants.clear();
  };

  return { bind, texture, constant, samplerOf, isUnfiltered, clear };
};

/** @param {[number, number]} a @param {[number, number]} b */
export const isSize = (a, b) => a[0] === b[0] && a[1] === b[1];
