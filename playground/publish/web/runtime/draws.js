// draws.js -- draws meshes: samples of colour and depth, blending, resolved into a texture at the end.
//
// A draw that begins with an earlier draw's samples and depth goes on in them, since WebGL cannot copy
// samples:
// the earlier draw is drawn again where only the later one is stale (see execution.js).

import { isSize } from "./binder.js";
import { failure } from "./context.js";
import { choose, CHOSEN_BY, pieces, ranges, vertices } from "./detail.js";
import { headerNames, whole } from "./formulas.js";

/** @import { Job, Work } from "./kernels.js"
 *  @import { Program } from "./programs.js"
 *  @import { Result } from "./textures.js" */

// ── Builds the meshes that draws may ask for, by name: engine/meshes.py.

/** Vertices, attribute by attribute with so many numbers each, and how to join them, three a triangle.
 *  @typedef {{attributes: Object<string, {size: number, data: Float32Array}>,
 *             indices: Uint32Array}} MeshData */

/** @typedef {Object<string, number>} Values */

const DETAILS = 3; // full grid, geomipmap, morph

/** What builds a mesh, and the draw's parameters that it reads with their least and greatest.
 *  @type {Object<string, {build: (values: Values) => MeshData, reads: Object<string, [number, number]>}>} */
const MESHES = {
  grid: { build: ({ grid }) => skirted(grid), reads: { grid: [2, 4097] } },
  sheet: { build: sheet, reads: {} },
  triangles: { build: ({ count }) => triangles(count), reads: { count: [1, 2 ** 20] } },
  land: {
    build: ({ detail, grid }) => (detail === 0 ? skirted(grid) : tile()),
    reads: { detail: [0, DETAILS - 1], grid: [2, 4097] },
  },
};

/** What a mesh is known by: its name and the parameters that it depends on.
 *  Throws where one is missing or out of range.
 *  @param {string} name @param {Object<string, any>} values @returns {string} */
export function meshKey(name, values) {
  const mesh = MESHES[name];
  if (!mesh) throw new Error(`there is no mesh '${name}'`);
  const found = Object.entries(mesh.reads).map(([parameter, [low, high]]) => {
    const value = values[parameter];
    if (!Number.isInteger(value)) {
      const other = parameter === "count" ? ', or count = "…" in its #pragma' : "";
      throw new Error(`mesh '${name}' needs a parameter 'uniform int ${parameter}'${other}`);
    }
    if (value < low || value > high) {
      throw new Error(`${parameter} = ${value}: mesh '${name}' takes ${low} to ${high}`);
    }
    return `${parameter} ${value}`;
  });
  return [name, ...found].join(", ");
}

/** Builds a mesh of values that `meshKey` takes. Attribute `corner`: east and north, 0 to 1, and 0 on the
 *  terrain or 1 at a skirt's foot; of a tile nodes, 0 to 16; of triangles which one, which vertex, and 0.
 *  @param {string} name @param {Object<string, any>} values @returns {MeshData} */
export function buildMesh(name, values) {
  return MESHES[name].build(values);
}

/** A square of n by n vertices with a skirt around it.
 *  @param {number} n @returns {MeshData} */
function skirted(n) {
  const rim = rimOf(n);
  const data = new Float32Array(3 * (n * n + rim.length));
  const step = 1 / (n - 1);
  const along = Float32Array.from({ length: n }, (_, i) => (i === n - 1 ? 1 : i * step));
  for (let j = 0, at = 0; j < n; j++) {
    for (let i = 0; i < n; i++, at += 3) {
      data[at] = along[i];
      data[at + 1] = along[j];
    }
  }
  const indices = new Uint32Array(6 * ((n - 1) * (n - 1) + rim.length));
  let at = 0;
  for (let j = 0; j < n - 1; j++) {
    for (let i = 0; i < n - 1; i++, at += 6) {
      const a = j * n + i, c = a + n + 1;
      indices.set([a, a + 1, c, a, c, a + n], at);
    }
  }
  rim.forEach((top, k) => {
    const next = (k + 1) % rim.length, low = n * n + k;
    data.set([data[3 * top], data[3 * top + 1], 1], 3 * low);
    indices.set([top, low, n * n + next, top, n * n + next, rim[next]], at);
    at += 6;
  });
  return { attributes: { corner: { size: 3, data } }, indices };
}

/** The vertices at the rim of a grid: along the south, up the east, back along the north, down the west.
 *  @param {number} n @returns {number[]} */
function rimOf(n) {
  const sides = Array.from({ length: n - 1 }, (_, k) => k);
  return [
    ...sides, ...sides.map((k) => k * n + n - 1), ...sides.map((k) => n * n - 1 - k),
    ...sides.map((k) => (n - 1 - k) * n),
  ];
}

/** @returns {MeshData} */
function sheet() {
  const data = new Float32Array([0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0]);
  return { attributes: { corner: { size: 3, data } }, indices: new Uint32Array([0, 1, 2, 0, 2, 3]) };
}

/** Triangles whose vertices share nothing.
 *  @param {number} count @returns {MeshData} */
function triangles(count) {
  const data = new Float32Array(9 * count);
  for (let vertex = 0; vertex < 3 * count; vertex++) {
    data[3 * vertex] = Math.floor(vertex / 3);
    data[3 * vertex + 1] = vertex % 3;
  }
  const indices = Uint32Array.from({ length: 3 * count }, (_, vertex) => vertex);
  return { attributes: { corner: { size: 3, data } }, indices };
}

/** One tile with every list of indices, one after another.
 *  @returns {MeshData} */
function tile() {
  const indices = Uint32Array.from([...pieces().values()].flat());
  return { attributes: { corner: { size: 3, data: vertices() } }, indices };
}

// ── Draws meshes

/** @typedef {{key: string, attributes: [string, number, WebGLBuffer][], indices: WebGLBuffer, length: number,
 *             tiles: WebGLBuffer | null}} Mesh */

const MAX_MESHES = 16, MAX_INSTANCES = 2 ** 20;

/** @param {import("./context.js").Context} context @param {import("./textures.js").Textures} textures
 *  @param {import("./programs.js").Programs} programs @param {import("./binder.js").Binder} binder
 *  @param {import("./kernels.js").Kernels} kernels */
export const createDraws = (context, textures, programs, binder, kernels) => {
  const { gl, make, drop } = context;
  /** @type {Map<string, Mesh>} */
  const meshes = new Map();

  /** @param {number} target @param {ArrayBufferView} data */
  const buffer = (target, data) => {
    const made = make("Buffer");
    gl.bindVertexArray(null);
    gl.bindBuffer(target, made);
    gl.bufferData(target, data, gl.STATIC_DRAW);
    return made;
  };

  /** @param {Mesh} mesh */
  const release = (mesh) => {
    programs.forgetMesh(mesh.key);
    [...mesh.attributes.map((each) => each[2]), mesh.indices, ...(mesh.tiles ? [mesh.tiles] : [])]
      .forEach((each) => drop("Buffer", each));
    meshes.delete(mesh.key);
  };

  /** A side of an input's texture, of a name as `list.size.x`; 1 where nothing is wired.
   *  @param {Job} job @param {string} name */
  const sizeOf = ({ inputs }, name) => {
    const [declared, , axis] = name.split("."), wired = inputs.get(declared);
    return wired ? wired.texture.size["xy".indexOf(axis)] : 1;
  };

  /** @param {Job} job @returns {Mesh} */
  const meshOf = (job) => {
    const { kernel } = job.step, name = /** @type {string} */ (kernel.mesh), values = { ...job.step.values };
    if (kernel.count !== undefined) {
      const names = headerNames(job.step, job.time);
      values.count = whole(kernel.count, { name: (each) => names.name(each) ?? sizeOf(job, each) });
    }
    const key = meshKey(name, values), known = meshes.get(key);
    meshes.delete(key);
    if (known) {
      meshes.set(key, known);
      return known;
    }
    const { attributes, indices } = buildMesh(name, values);
    /** @type {Mesh} */
    const made = {
      key, length: indices.length,
      attributes: Object.entries(attributes).map(([attribute, { size, data }]) =>
        [attribute, size, buffer(gl.ARRAY_BUFFER, data)]),
      indices: buffer(gl.ELEMENT_ARRAY_BUFFER, indices),
      tiles: name in CHOSEN_BY ? make("Buffer") : null,
    };
    meshes.set(key, made);
    if (meshes.size > MAX_MESHES) release(/** @type {Mesh} */ (meshes.values().next().value));
    return made;
  };

  /** Bind the vertex array of a mesh for a program. @param {Program} program @param {Mesh} mesh */
  const bindArray = (program, mesh) => {
    const known = program.arrays.get(mesh.key);
    if (known) {
      gl.bindVertexArray(known);
      return;
    }
    const made = make("VertexArray");
    program.arrays.set(mesh.key, made);
    gl.bindVertexArray(made);
    gl.bindBuffer(gl.ELEMENT_ARRAY_BUFFER, mesh.indices);
    for (const [name, size, data] of mesh.attributes) attribute(program, name, size, data, 0);
    if (mesh.tiles) attribute(program, "tile", 4, mesh.tiles, 1);
  };

  /** @param {Program} program @param {string} name @param {number} size @param {WebGLBuffer} data
   *  @param {number} divisor */
  const attribute = (program, name, size, data, divisor) => {
    const at = gl.getAttribLocation(program.program, `k_in_${name}`);
    if (at < 0) return;
    gl.bindBuffer(gl.ARRAY_BUFFER, data);
    gl.enableVertexAttribArray(at);
    gl.vertexAttribPointer(at, size, gl.FLOAT, false, 0, 0);
    gl.vertexAttribDivisor(at, divisor);
  };

  /** Return the texels of an input, read once each time that they are computed. @param {Job} job
   *  @param {string} name */
  const tableOf = ({ step, inputs }, name) => {
    const wired = inputs.get(name);
    if (!wired) {
      const which = `mesh '${step.kernel.mesh}' at this detail`;
      throw failure("sketch", `pass '${step.path}': ${which} needs the input '${name}' wired`);
    }
    const { read } = wired.result;
    if (!read.has(wired.output)) read.set(wired.output, readTexture(context, textures, wired.texture));
    return { size: wired.texture.size, data: /** @type {Float32Array} */ (read.get(wired.output)) };
  };

  /** Return what to draw of a mesh with levels of detail. @param {Job} job */
  const chosenOf = (job) => {
    const { step, given } = job, mesh = /** @type {string} */ (step.kernel.mesh);
    const tables = () => Object.fromEntries(CHOSEN_BY[mesh].map((name) => [name, tableOf(job, name)]));
    const view = {
      clipFromWorld: given.clip_from_world, eye: given.eye, extent: given.extent, relief: given.relief,
      size: step.size,
    };
    return choose(mesh, step.values, tables, view);
  };

  /** Begin with an earlier draw's samples and depth, with a texture's colours, or with nothing.
   *  @param {Job} job */
  const begun = (job) => {
    const { step, samples, inputs } = job, { outputs } = step.kernel;
    const wired = inputs.get("initial"), owner = wired && (wired.result.of || wired.result);
    if (wired && owner && owner.surface && isSize(owner.surface.size, step.size)) {
      const { surface } = owner, given = [...wired.result.textures.keys()];
      if (given.length !== outputs.length || given[0] !== wired.output) {
        const own = outputs.map(({ name }) => name).join(", ");
        const what = `a draw of ${given.join(", ")}; it gives ${own}, and they must be as many`;
        const { path } = /** @type {any} */ (step.inputs.find(([name]) => name === "initial"))[1];
        throw failure("sketch", `pass '${step.path}' goes on from '${path}', ${what}`);
      }
      owner.surface = null;
      return surface;
    }
    const surface = textures.surface(step.size, outputs.map(({ format }) => format), samples);
    gl.bindFramebuffer(gl.FRAMEBUFFER, surface.target);
    gl.clearColor(0, 0, 0, 0);
    gl.clear(gl.COLOR_BUFFER_BIT | gl.DEPTH_BUFFER_BIT);
    const begins = started(outputs, wired);
    outputs.forEach(({ name }, i) => {
      const texture = begins.get(name);
      if (texture) copyInto(surface, i, texture);
    });
    return surface;
  };

  /** Begin one of a surface's outputs with a texture.
   *  @param {import("./textures.js").Surface} surface @param {number} unit
   *  @param {import("./textures.js").Texture} texture */
  const copyInto = (surface, unit, texture) => {
    const { buffers, size } = surface;
    if (buffers.length === 2) {
      kernels.copy(surface.target, size, texture);
      return;
    }
    const single = make("Framebuffer");
    gl.bindFramebuffer(gl.FRAMEBUFFER, single);
    gl.framebufferRenderbuffer(gl.FRAMEBUFFER, gl.COLOR_ATTACHMENT0, gl.RENDERBUFFER, buffers[unit]);
    kernels.copy(single, size, texture);
    drop("Framebuffer", single);
  };

  /** How often a draw draws its mesh: an expression, which may name an input's first texel.
   *  @param {Job} job */
  const instancesOf = (job) => {
    const { step } = job, { instances, mesh } = step.kernel;
    if (instances === undefined) return 1;
    if (mesh && mesh in CHOSEN_BY) {
      const why = `mesh '${mesh}' is drawn once for each of its tiles; it takes no instances`;
      throw failure("sketch", `pass '${step.path}': ${why}`);
    }
    const names = headerNames(step, job.time), found = whole(instances, {
      name: (name) => names.name(name) ?? componentOf(job, name),
    });
    if (found >= 0 && found <= MAX_INSTANCES) return found;
    const message = `instances = ${found}; 0 to ${MAX_INSTANCES} were expected`;
    throw failure("sketch", `pass '${step.path}': ${message}`);
  };

  /** A component of an input's first texel, of a name as `list.x`; read once each time that it is computed.
   *  @param {Job} job @param {string} name */
  const componentOf = ({ step, inputs }, name) => {
    const [declared, component] = name.split("."), wired = inputs.get(declared);
    if (!wired) throw failure("sketch", `pass '${step.path}': nothing is wired to '${declared}'`);
    const { read } = wired.result, key = `${wired.output} first`;
    if (!read.has(key)) read.set(key, readTexture(context, textures, wired.texture, [1, 1]));
    const number = /** @type {Float32Array} */ (read.get(key))["xyzw".indexOf(component)];
    if (Number.isFinite(number)) return number;
    const message = `'${declared}' holds ${number} as its ${component}; a number was expected`;
    throw failure("sketch", `pass '${step.path}': instances: ${message}`);
  };

  /** Draw a mesh over what the draw begins with; the result is the caller's. @param {Job} job
   *  @returns {Work} */
  const run = function* (job) {
    const { step, text } = job, { kernel, size } = step;
    const floats = kernel.outputs.some(({ format }) => textures.formats(format).float32);
    if (kernel.blend !== "none" && !context.floatBlend && floats)
      throw failure("no-float-blend", `pass '${step.path}': this device cannot blend 32-bit numbers.`);
    const program = kernels.programOf(job), reads = kernels.readsOf(job), mesh = meshOf(job);
    const instances = step.repeat ? instancesOf(job) : 0;
    const chosen = mesh.tiles && step.repeat ? chosenOf(job) : null;
    const surface = begun(job);
    /** @type {Result | null} */
    let result = null;
    const begin = () => {
      gl.bindFramebuffer(gl.FRAMEBUFFER, surface.target);
      gl.viewport(0, 0, ...size);
      binder.bind(program, job, reads);
      bindArray(program, mesh);
      if (kernel.depth !== "none") gl.enable(gl.DEPTH_TEST);
      if (kernel.blend !== "none") gl.enable(gl.BLEND);
      gl.depthFunc(kernel.depth === "equal" ? gl.EQUAL : gl.LESS);
      if (kernel.blend === "add") gl.blendFunc(gl.ONE, gl.ONE);
      else gl.blendFuncSeparate(gl.SRC_ALPHA, gl.ONE_MINUS_SRC_ALPHA, gl.ONE, gl.ONE_MINUS_SRC_ALPHA);
    };
    const end = () => {
      gl.disable(gl.DEPTH_TEST);
      gl.disable(gl.BLEND);
      gl.bindVertexArray(null);
    };
    try {
      begin();
      for (let iteration = 0; iteration < step.repeat; iteration++) {
        kernels.count(program, job, iteration);
        if (chosen) drawTiles(mesh, chosen);
        else gl.drawElementsInstanced(gl.TRIANGLES, mesh.length, gl.UNSIGNED_INT, 0, instances);
        end();
        yield { step, text, texels: size[0] * size[1] };
        if (iteration + 1 < step.repeat) begin();
      }
      result = textures.take(size, kernel.outputs, job.tall);
      textures.resolve(surface, result);
      if (job.keepsSurface) result.surface = surface;
      return result;
    } finally {
      end();
      if (!result || !result.surface) textures.giveSurface(surface);
    }
  };

  /** Draw each piece once for all of its tiles.
   *  @param {Mesh} mesh @param {{runs: [string, number][], places: Float32Array}} chosen */
  const drawTiles = (mesh, { runs, places }) => {
    const known = ranges();
    let done = 0;
    for (const [piece, count] of runs) {
      const [first, length] = known.get(piece) || [0, mesh.length];
      gl.bindBuffer(gl.ARRAY_BUFFER, mesh.tiles);
      gl.bufferData(gl.ARRAY_BUFFER, places.subarray(4 * done, 4 * (done + count)), gl.DYNAMIC_DRAW);
      gl.drawElementsInstanced(gl.TRIANGLES, length, gl.UNSIGNED_INT, 4 * first, count);
      done += count;
    }
  };

  return { run, clear: () => [...meshes.values()].forEach(release) };
};

/** The textures that a draw's outputs begin with: what is wired, and beside it the outputs of their names.
 *  @param {{name: string}[]} outputs @param {import("./binder.js").Wired | null | undefined} wired
 *  @returns {Map<string, import("./textures.js").Texture>} */
export const started = (outputs, wired) => {
  const found = new Map();
  outputs.forEach(({ name }, i) => {
    const texture = i ? wired?.result.textures.get(name) : wired?.texture;
    if (texture) found.set(name, texture);
  });
  return found;
};

/** Return the texels of a texture as floats, or those of its south-west corner; those of normalised formats
 *  are 0..1.
 *  @param {import("./context.js").Context} context @param {import("./textures.js").Textures} textures
 *  @param {import("./textures.js").Texture} texture @param {[number, number]} [size]
 *  @returns {Float32Array} */
export const readTexture = ({ gl }, textures, texture, size = texture.size) => {
  const { channels, type } = textures.formats(texture.format), [width, height] = size;
  const bytes = type === gl.UNSIGNED_BYTE, shorts = type === gl.UNSIGNED_SHORT;
  const all = new (bytes ? Uint8Array : shorts ? Uint16Array : Float32Array)(4 * width * height);
  gl.bindFramebuffer(gl.FRAMEBUFFER, textures.targetOf(texture));
  gl.readPixels(0, 0, width, height, gl.RGBA, bytes || shorts ? type : gl.FLOAT, all);
  const found = new Float32Array(channels * width * height), top = bytes ? 255 : shorts ? 65535 : 1;
  for (let i = 0; i < width * height; i++)
    for (let c = 0; c < channels; c++) found[channels * i + c] = all[4 * i + c] / top;
  return found;
};
