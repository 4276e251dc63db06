// context.js -- a WebGL2 context: what it can do, what it lacks, and how many of its objects live.

// ── Waits for other events, and for the graphics card, without holding the page up.

/** Wait until other events had their turn. @param {number} [milliseconds] */
const pause = (milliseconds) => new Promise((resume) => {
  if (milliseconds) {
    setTimeout(resume, milliseconds);
    return;
  }
  const { port1, port2 } = new MessageChannel();
  port1.onmessage = () => {
    port1.close();
    resume(undefined);
  };
  port2.postMessage(0);
});

/** Wait until everything drawn so far is done. @param {WebGL2RenderingContext} gl @returns {Promise<void>} */
export const finished = async (gl) => {
  const fence = gl.fenceSync(gl.SYNC_GPU_COMMANDS_COMPLETE, 0);
  gl.flush();
  if (!fence) return;
  for (let polls = 0; !gl.isContextLost(); polls++) {
    await pause(polls > 4 ? 2 : 0);
    if (gl.clientWaitSync(fence, 0, 0) !== gl.TIMEOUT_EXPIRED) break;
  }
  gl.deleteSync(fence);
};

// ── A WebGL2 context

/** An error that a page can tell: a code for its own words, and a sentence.
 *  @typedef {Error & {code: string, sentence: string}} Failure */

/** @typedef {"Texture" | "Framebuffer" | "Renderbuffer" | "Buffer" | "VertexArray" | "Program" | "Shader" |
 *            "Sampler"} Kind */

/** @typedef {object} Context
 *  @property {WebGL2RenderingContext} gl
 *  @property {boolean} floatLinear     whether textures of 32-bit floats are filtered
 *  @property {boolean} floatBlend      whether draws on 32-bit floats may blend
 *  @property {EXT_texture_norm16 | null} norm16   null: formats of 16 bits are 32-bit floats
 *  @property {KHR_parallel_shader_compile | null} parallel
 *  @property {boolean} software        whether a program draws, not a graphics card
 *  @property {[number, number]} anisotropy   of textures with mipmaps: the parameter's name, and how much
 *  @property {{size: number, units: number, spare: number, outputs: number}} limits   texels, texture units
 *  @property {number} objects          objects made so far
 *  @property {(kind: Kind, ...how: any[]) => any} make
 *  @property {(kind: Kind, object: any) => void} drop
 *  @property {() => Object<string, number>} counts   objects that live, by kind
 *  @property {(where: string) => void} check   raise what WebGL reports */

const ANISOTROPY = 8; // of textures with mipmaps

/** @param {string} code @param {string} sentence @param {object} [more] @returns {Failure} */
export const failure = (code, sentence, more = {}) =>
  Object.assign(new Error(sentence), { code, sentence }, more);

/** Whether a renderer is a program. @param {WebGL2RenderingContext} gl */
const isSoftware = (gl) => {
  const named = gl.getExtension("WEBGL_debug_renderer_info");
  const name = gl.getParameter(named ? named.UNMASKED_RENDERER_WEBGL : gl.RENDERER);
  return /llvmpipe|softpipe|swiftshader|basic render|software/i.test(name);
};

/** Open a canvas's context; `without` lists extensions to do without.
 *  @param {HTMLCanvasElement | OffscreenCanvas} canvas
 *  @param {{without?: string[]}} [options]
 *  @returns {Context} */
export const openContext = (canvas, { without = [] } = {}) => {
  const plain = { antialias: false, alpha: false, depth: false, stencil: false };
  const how = { ...plain, powerPreference: "high-performance" };
  const gl = /** @type {WebGL2RenderingContext | null} */ (canvas.getContext("webgl2", how));
  if (!gl) throw failure("no-webgl2", "This browser offers no WebGL2.");
  /** @param {string} name */
  const extension = (name) => (without.includes(name) ? null : gl.getExtension(name));
  if (!extension("EXT_color_buffer_float") && !gl.isContextLost())
    throw failure("no-float-targets", "This device cannot draw into textures of floating-point numbers.");
  /** @type {Object<string, number>} */
  const live = {};
  const any = /** @type {any} */ (gl), software = isSoftware(gl);
  const anisotropic = extension("EXT_texture_filter_anisotropic");
  /** @type {Context} */
  const context = {
    gl,
    floatLinear: !!extension("OES_texture_float_linear"),
    floatBlend: !!extension("EXT_float_blend"),
    norm16: extension("EXT_texture_norm16"),
    parallel: extension("KHR_parallel_shader_compile"),
    software,
    // In software it costs a hundred times as much.
    anisotropy: software || !anisotropic ? [0, 1] : [
      anisotropic.TEXTURE_MAX_ANISOTROPY_EXT,
      Math.min(ANISOTROPY, gl.getParameter(anisotropic.MAX_TEXTURE_MAX_ANISOTROPY_EXT)),
    ],
    limits: {
      size: gl.getParameter(gl.MAX_TEXTURE_SIZE),
      units: gl.getParameter(gl.MAX_TEXTURE_IMAGE_UNITS),
      spare: gl.getParameter(gl.MAX_COMBINED_TEXTURE_IMAGE_UNITS) - 1, // no sampler of ours reads this one
      outputs: gl.getParameter(gl.MAX_DRAW_BUFFERS),
    },
    objects: 0,
    make: (kind, ...how) => {
      const made = any[`create${kind}`](...how);
      if (!made) throw failure("context-lost", "The graphics context was lost.");
      live[kind] = (live[kind] || 0) + 1;
      context.objects++;
      return made;
    },
    drop: (kind, object) => {
      any[`delete${kind}`](object);
      live[kind]--;
    },
    counts: () => ({ ...live }),
    check: (where) => {
      const error = gl.getError();
      if (!error) return;
      while (!gl.isContextLost() && gl.getError());
      if (error === gl.CONTEXT_LOST_WEBGL) throw failure("context-lost", "The graphics context was lost.");
      const full = `${where}: the graphics memory is full.`;
      if (error === gl.OUT_OF_MEMORY) throw failure("out-of-memory", full);
      throw failure("webgl", `${where}: WebGL reports error 0x${error.toString(16)}.`);
    },
  };
  gl.pixelStorei(gl.UNPACK_ALIGNMENT, 1);
  gl.pixelStorei(gl.PACK_ALIGNMENT, 1);
  gl.pixelStorei(gl.UNPACK_COLORSPACE_CONVERSION_WEBGL, gl.NONE);
  return context;
};
