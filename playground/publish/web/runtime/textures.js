// textures.js -- textures and what draws to them; spare ones are used again, under a budget.

import { failure } from "./context.js";
import { unpacked } from "./packed.js";

// ── The formats of textures: what WebGL calls them, and what one without 16-bit channels takes
// instead.

/** @typedef {object} Format
 *  @property {number} internal
 *  @property {number} external
 *  @property {number} type
 *  @property {number} channels
 *  @property {number} bytes         of a texel
 *  @property {boolean} float32
 *  @property {number} steps         a normalised format kept in floats: its steps from 0 to 1; else 0 */

/** @param {import("./context.js").Context} context @returns {(name: string) => Format} */
const formatsOf = ({ gl, norm16 }) => {
  const any = /** @type {any} */ (gl);
  /** @type {Map<string, Format>} */
  const known = new Map();
  /** @param {string} name @returns {Format} */
  const made = (name) => {
    if (name === "srgb8") return { ...made("rgba8"), internal: gl.SRGB8_ALPHA8 };
    const [, letters, kind] = /** @type {RegExpExecArray} */ (/^([rgba]+)(\w+)$/.exec(name));
    const channels = letters.length, external = [gl.RED, gl.RG, gl.RGB, gl.RGBA][channels - 1];
    if (kind === "16" && !norm16) return { ...made(`${letters}32f`), steps: 65535 };
    const internal = kind === "16" ? /** @type {any} */ (norm16)[`${letters.toUpperCase()}16_EXT`]
      : any[letters.toUpperCase() + kind.toUpperCase()];
    const type = { 8: gl.UNSIGNED_BYTE, 16: gl.UNSIGNED_SHORT, "16f": gl.HALF_FLOAT, "32f": gl.FLOAT }[kind];
    if (!internal || !type) throw new Error(`format ${name}`);
    const bytes = (channels * parseInt(kind)) / 8;
    return { internal, external, type, channels, bytes, float32: kind === "32f", steps: 0 };
  };
  return (name) => {
    let found = known.get(name);
    if (!found) known.set(name, (found = made(name)));
    return found;
  };
};

/** Return what a kernel's fragment shader writes last where normalised formats are kept in floats.
 *  @param {{name: string, format: string}[]} outputs @param {(name: string) => Format} formats */
export const roundedOutputs = (outputs, formats) =>
  outputs.filter((output) => formats(output.format).steps).map(({ name, format }) => {
    const steps = formats(format).steps.toFixed(1);
    return ` k_out_${name} = floor(clamp(k_out_${name}, 0.0, 1.0) * ${steps} + 0.5) / ${steps};`;
  }).join("");

/** Return a format's texels as what is uploaded. @param {WebGL2RenderingContext} gl @param {Format} format
 *  @param {ArrayBuffer} bytes as Python writes them */
export const texelsOf = (gl, { type, steps }, bytes) => {
  if (steps) return Float32Array.from(new Uint16Array(bytes), (value) => value / steps);
  return new (type === gl.UNSIGNED_BYTE ? Uint8Array : type === gl.FLOAT ? Float32Array : Uint16Array)(bytes);
};

// ── Textures and what draws to them

/** @typedef {{texture: WebGLTexture, size: [number, number], format: string, levels: number, bytes: number,
 *             target: WebGLFramebuffer | null}} Texture */

/** Samples of colour and depth that a draw draws on.
 *  @typedef {{target: WebGLFramebuffer, buffers: WebGLRenderbuffer[], size: [number, number],
 *             formats: string, samples: number, bytes: number}} Surface */

/** The textures that one pass computed.
 *  @typedef {object} Result
 *  @property {[number, number]} size
 *  @property {Map<string, Texture>} textures   by output
 *  @property {WebGLFramebuffer | null} target  of several outputs
 *  @property {number} iterations               done, of a pass that repeats
 *  @property {number} settled                  the steps that ran, where they changed nothing more; else 0
 *  @property {number} number                   of all that were handed out: textures are used again, it is
 *  not
 *  @property {Surface | null} surface          a draw's samples and depth, while a later draw may go on
 *  from it
 *  @property {Set<string>} mipmapped           outputs whose levels are made
 *  @property {Map<string, Texture>} copies     of outputs, with levels
 *  @property {Map<string, Float32Array>} read  of outputs, on the processor
 *  @property {Result | null} of                the result whose textures and surface these are
 *  @property {boolean} gone                    its textures are others' by now */

/** @typedef {ReturnType<typeof createTextures>} Textures */

const SURFACES = 2;

/** @param {import("./context.js").Context} context @param {number} limit bytes of spare textures */
export const createTextures = (context, limit) => {
  const { gl, make, drop } = context, formats = formatsOf(context);
  /** @type {Set<string>} */
  const complete = new Set();
  /** @type {Result[]} */
  const spare = [];
  /** @type {Surface[]} */
  const surfaces = [];
  let bytes = 0, taken = 0;

  /** Bind a texture where no sampler reads it. @param {WebGLTexture} texture */
  const hold = (texture) => {
    gl.activeTexture(gl.TEXTURE0 + context.limits.spare);
    gl.bindTexture(gl.TEXTURE_2D, texture);
  };

  /** @param {[number, number]} size @param {string} format @param {boolean} [levels] whether it has mipmaps
   *  @returns {Texture} */
  const texture = (size, format, levels = false) => {
    if (Math.max(...size) > context.limits.size) {
      const sides = size.join(" × ");
      const most = `this device takes no more than ${context.limits.size} a side`;
      throw failure("too-large", `${sides} texels; ${most}.`);
    }
    const made = make("Texture"), many = levels ? 1 + Math.floor(Math.log2(Math.max(...size))) : 1;
    const { internal, bytes: each } = formats(format), flat = size[0] * size[1] * each;
    hold(made);
    gl.texStorage2D(gl.TEXTURE_2D, many, internal, ...size);
    const bytes = many > 1 ? Math.ceil(flat * 4 / 3) : flat;
    return { texture: made, size, format, levels: many, bytes, target: null };
  };

  /** @param {Texture} made @param {ArrayBufferView | ImageBitmap} texels */
  const write = (made, texels) => {
    const { external, type } = formats(made.format);
    hold(made.texture);
    gl.texSubImage2D(gl.TEXTURE_2D, 0, 0, 0, ...made.size, external, type, /** @type {any} */ (texels));
  };

  /** @param {Texture} made */
  const buildLevels = (made) => {
    hold(made.texture);
    gl.generateMipmap(gl.TEXTURE_2D);
  };

  /** @param {Texture} made */
  const release = (made) => {
    if (made.target) drop("Framebuffer", made.target);
    drop("Texture", made.texture);
  };

  /** Bind a framebuffer, and ask once for each kind whether it is complete.
   *  @param {string} kind */
  const checked = (kind) => {
    if (complete.has(kind)) return;
    const status = gl.checkFramebufferStatus(gl.FRAMEBUFFER);
    if (status !== gl.FRAMEBUFFER_COMPLETE && !gl.isContextLost())
      throw failure("no-target", `This device cannot draw into ${kind} (0x${status.toString(16)}).`);
    complete.add(kind);
  };

  /** @param {Texture[]} textures */
  const framebuffer = (textures) => {
    const made = make("Framebuffer");
    gl.bindFramebuffer(gl.FRAMEBUFFER, made);
    textures.forEach((each, i) =>
      gl.framebufferTexture2D(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0 + i, gl.TEXTURE_2D, each.texture, 0));
    if (textures.length > 1) gl.drawBuffers(textures.map((_, i) => gl.COLOR_ATTACHMENT0 + i));
    checked(textures.map((each) => each.format).join(", "));
    return made;
  };

  /** @param {Texture} made */
  const targetOf = (made) => (made.target ||= framebuffer([made]));

  /** Bind what draws to all textures of a result. @param {Result} result */
  const drawTo = (result) => {
    const all = [...result.textures.values()];
    const target = all.length === 1 ? targetOf(all[0]) : (result.target ||= framebuffer(all));
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  };

  /** @param {Result} result */
  const bytesOf = (result) => {
    let total = result.surface ? result.surface.bytes : 0;
    for (const each of result.textures.values()) total += each.bytes;
    for (const each of result.copies.values()) total += each.bytes;
    return total;
  };

  /** @param {[number, number]} size @param {Map<string, Texture>} textures @param {Partial<Result>} [more]
   *  @returns {Result} */
  const result = (size, textures, more) => ({
    size, textures, target: null, iterations: 0, settled: 0, number: ++taken, surface: null,
    mipmapped: new Set(),
    copies: new Map(), read: new Map(), of: null, gone: false, ...more,
  });

  /** Return textures with undefined texels; `tall` says which outputs have levels.
   *  @param {[number, number]} size @param {{name: string, format: string}[]} outputs
   *  @param {(name: string) => boolean} tall @returns {Result} */
  const take = (size, outputs, tall) => {
    const many = Math.max(...size) > 1;
    const kinds = outputs.map(({ name, format }) => `${format} ${many && tall(name)}`).join();
    for (let i = spare.length - 1; i >= 0; i--) {
      const found = spare[i], all = [...found.textures.values()];
      if (found.size[0] !== size[0] || found.size[1] !== size[1]) continue;
      if (all.map((each) => `${each.format} ${each.levels > 1}`).join() !== kinds) continue;
      spare.splice(i, 1);
      bytes -= bytesOf(found);
      return result(size, new Map(outputs.map(({ name }, k) => [name, all[k]])), { target: found.target });
    }
    const made = new Map();
    try {
      for (const { name, format } of outputs) made.set(name, texture(size, format, tall(name)));
    } catch (error) {
      made.forEach(release);
      throw error;
    }
    return result(size, made);
  };

  /** @param {Result} dropped */
  const destroy = (dropped) => {
    if (dropped.target) drop("Framebuffer", dropped.target);
    dropped.textures.forEach(release);
  };

  /** Take back what is no longer read. @param {Result} given */
  const give = (given) => {
    if (given.gone) return;
    given.gone = true;
    if (given.of) return;
    if (given.surface) giveSurface(given.surface);
    given.surface = null;
    given.copies.forEach(release);
    given.copies.clear();
    given.read.clear();
    spare.push({ ...given });
    bytes += bytesOf(given);
    trim(limit);
  };

  /** @param {number} most bytes */
  const trim = (most) => {
    while (bytes > most && spare.length) {
      const oldest = /** @type {Result} */ (spare.shift());
      bytes -= bytesOf(oldest);
      destroy(oldest);
    }
  };

  /** @param {[number, number]} size @param {string[]} list formats, of each output
   *  @param {number} wanted samples @returns {Surface} */
  const surface = (size, list, wanted) => {
    const kinds = list.map(formats), named = list.join(", ");
    const samples = wanted > 1 ? Math.min(...list.map((format) => samplesOf(format, wanted))) : 0;
    const at = surfaces.findIndex((known) => known.size[0] === size[0] && known.size[1] === size[1]
      && known.formats === named && known.samples === samples);
    if (at >= 0) return surfaces.splice(at, 1)[0];
    const target = make("Framebuffer"), drawn = kinds.map((_, i) => gl.COLOR_ATTACHMENT0 + i);
    const stored = [...kinds.map(({ internal }) => internal), gl.DEPTH_COMPONENT24];
    gl.bindFramebuffer(gl.FRAMEBUFFER, target);
    const buffers = [...drawn, gl.DEPTH_ATTACHMENT].map((where, i) => {
      const made = make("Renderbuffer");
      gl.bindRenderbuffer(gl.RENDERBUFFER, made);
      gl.renderbufferStorageMultisample(gl.RENDERBUFFER, samples, stored[i], ...size);
      gl.framebufferRenderbuffer(gl.FRAMEBUFFER, where, gl.RENDERBUFFER, made);
      return made;
    });
    if (drawn.length > 1) gl.drawBuffers(drawn);
    checked(`${named} of ${samples} samples`);
    const each = kinds.reduce((sum, { bytes: own }) => sum + own, 4);
    const taken = size[0] * size[1] * each * (samples || 1);
    return { target, buffers, size, formats: named, samples, bytes: taken };
  };

  /** Copy what was drawn, its samples resolved, into a result's textures.
   *  @param {Surface} from @param {Result} to */
  const resolve = ({ target, size }, to) => {
    const all = [...to.textures.values()], last = all.length - 1;
    drawTo(to);
    gl.bindFramebuffer(gl.READ_FRAMEBUFFER, target);
    all.forEach((_, i) => { // what is read goes into every buffer that is drawn to: each in its turn
      if (last) gl.drawBuffers(all.map((_, k) => (k === i ? gl.COLOR_ATTACHMENT0 + k : gl.NONE)));
      if (last) gl.readBuffer(gl.COLOR_ATTACHMENT0 + i);
      gl.blitFramebuffer(0, 0, ...size, 0, 0, ...size, gl.COLOR_BUFFER_BIT, gl.NEAREST);
    });
    if (last) gl.drawBuffers(all.map((_, k) => gl.COLOR_ATTACHMENT0 + k));
    if (last) gl.readBuffer(gl.COLOR_ATTACHMENT0);
  };

  /** @type {Map<string, number[]>} */
  const offered = new Map();
  /** Return how many samples a format has here: those wanted, or the next that is offered, or the most.
   *  @param {string} format @param {number} wanted */
  const samplesOf = (format, wanted) => {
    const { internal } = formats(format);
    let list = offered.get(format);
    if (!list) {
      list = [...gl.getInternalformatParameter(gl.RENDERBUFFER, internal, gl.SAMPLES)];
      offered.set(format, list);
    }
    const least = list.filter((many) => many >= wanted).sort((a, b) => a - b)[0];
    return least ?? Math.max(0, ...list);
  };

  /** @param {Surface} given */
  const giveSurface = (given) => {
    surfaces.push(given);
    while (surfaces.length > SURFACES) releaseSurface(/** @type {Surface} */ (surfaces.shift()));
  };

  /** @param {Surface} given */
  const releaseSurface = (given) => {
    drop("Framebuffer", given.target);
    given.buffers.forEach((each) => drop("Renderbuffer", each));
  };

  const clear = () => {
    trim(-1);
    surfaces.splice(0).forEach(releaseSurface);
  };

  return {
    formats, texture, write, buildLevels, release, targetOf, drawTo, bytesOf, result, take, give, surface,
    resolve, giveSurface, clear, get bytes() { return bytes; },
  };
};

// ── What a page carries as bytes: blobs, and image files as textures.

/** @typedef {ReturnType<typeof createImages>} Images */

/** @param {Textures} textures @param {import("./schema.js").Shared} shared */
export const createImages = (textures, shared) => {
  /** @type {Map<string, Promise<ArrayBuffer>>} */
  const asked = new Map();
  /** @type {Map<string, ArrayBuffer>} */
  const blobs = new Map();
  /** @type {Map<string, Texture>} */
  const made = new Map();

  /** @param {string} key */
  const loadBlob = async (key) => {
    if (blobs.has(key)) return;
    if (!asked.has(key)) asked.set(key, unpacked(shared.blobs[key]));
    blobs.set(key, await /** @type {Promise<ArrayBuffer>} */ (asked.get(key)));
    asked.delete(key);
  };

  /** Make the texture of an image file, if it is not made.
   *  @param {string} key @param {import("./schema.js").Sampling} sampling */
  const load = async (key, { mipmap, flip = false }) => {
    const image = shared.images[key], name = `${key} ${flip}`, known = made.get(name);
    if (!image) throw failure("no-image", `The page carries no image '${key}'.`);
    if (known && (known.levels > 1 || !mipmap)) return;
    const bytes = await unpacked(shared.blobs[image.blob]);
    const texels = image.file ? await decoded(bytes, image.file, flip) : inRows(bytes, image, flip);
    const texture = textures.texture(image.size, image.kind, mipmap);
    textures.write(texture, texels);
    if (mipmap) textures.buildLevels(texture);
    const before = made.get(name); // loaded meanwhile
    if (before) textures.release(before);
    made.set(name, texture);
  };

  return {
    load, loadBlob,

    /** Return the texture of an image that was loaded.
     *  @param {string} key @param {import("./schema.js").Sampling} sampling @returns {Texture} */
    get: (key, { flip = false }) => {
      const found = made.get(`${key} ${flip}`);
      if (!found) throw failure("no-image", `The image '${key}' is not loaded.`);
      return found;
    },

    /** Return the bytes of a blob that was loaded. @param {string} key @returns {ArrayBuffer} */
    blob: (key) => {
      const found = blobs.get(key);
      if (!found) throw failure("no-image", `The data '${key}' are not loaded.`);
      return found;
    },

    clear: () => {
      made.forEach(textures.release);
      made.clear();
      blobs.clear();
    },
  };
};

/** Return an image file's pixels as they are encoded, row 0 south unless `flip`.
 *  @param {ArrayBuffer} bytes @param {string} type @param {boolean} flip */
const decoded = (bytes, type, flip) => createImageBitmap(new Blob([bytes], { type }),
  { premultiplyAlpha: "none", colorSpaceConversion: "none", imageOrientation: flip ? "none" : "flipY" });

/** Return texels, their rows the other way round where `flip`.
 *  @param {ArrayBuffer} bytes @param {{size: [number, number], kind: string}} image @param {boolean} flip */
const inRows = (bytes, { size: [, height], kind }, flip) => {
  const all = kind === "rgba16f" ? new Uint16Array(bytes) : new Uint8Array(bytes), row = all.length / height;
  if (!flip) return all;
  const found = all.slice();
  for (let y = 0; y < height; y++) found.set(all.subarray(y * row, (y + 1) * row), (height - 1 - y) * row);
  return found;
};
