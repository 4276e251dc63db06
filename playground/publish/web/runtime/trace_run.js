// trace_run.js -- draws a traced shader for one texel, and reads the events that it records: engine/trace.
//
// Besides its own outputs a traced text has two of unsigned numbers: bits, and place, type, count. Texel k of
// the target runs the shader for the chosen texel as it is, and keeps the k-th event.

import { PLAIN } from "./binder.js";
import { failure } from "./context.js";
import { headerNames, whole } from "./formulas.js";
import { stagesOf, toES } from "./kernel_texts.js";
import { setUniform } from "./programs.js";
import { rebuild } from "./trace_values.js";

/** @import { Engine } from "./engine.js"
 *  @import { Job } from "./kernels.js"
 *  @import { Player } from "./player.js"
 *  @import { TracedText } from "./schema.js"
 *  @import { Result } from "./textures.js" */

/** The run of one texel.
 *  @typedef {object} Trace
 *  @property {string} path          of the pass
 *  @property {[number, number]} texel
 *  @property {import("./schema.js").Kernel} kernel
 *  @property {number} iteration     of its repeat, or of the loop around it
 *  @property {number} total         how many of these there are
 *  @property {import("./trace_values.js").Run} run
 *  @property {boolean} isComplete   else there are more events than are read
 *  @property {boolean} isExact      the traced run gives the texel, bit for bit
 *  @property {number[][]} outputs   of the traced run, by output */

const WIDTH = 256, ROWS = 16; // texels of the first target: most runs have fewer events
const MAX_ROWS = 256;
/** Texts whose compiler crashed, and the graphics context with it: they are not tried again.
 *  @type {WeakSet<TracedText>} */
const refused = new WeakSet();
const HELD = { 0x1406: Float32Array, 0x1401: Uint8Array, 0x1403: Uint16Array, 0x140b: Uint16Array };

/** Trace a texel of a pass as the player's picture has it; throws a `Failure` where that cannot be.
 *  @param {Engine} engine @param {Player} player @param {string} path @param {[number, number]} texel
 *  @param {number | null} iteration null: the last @returns {Trace} */
export function traced(engine, player, path, texel, iteration) {
  /** @type {ArrayBufferView[]} */
  let real = [];
  /** @type {Omit<Trace, "iteration" | "total"> | null} */
  let found = null;
  const visited = player.visit(path, iteration, {
    read: (made) => { real = texelsAt(engine, made, texel); },
    run: (job, before, now) => { found = drawn(engine, player, job, before, now, texel, real); },
  });
  if (!found) throw failure("no-trace", `Pass '${path}' has not run.`);
  return { .../** @type {Omit<Trace, "iteration" | "total">} */ (found), ...visited };
}

/** Return the traced text of a kernel, or why there is none.
 *  @param {Player} player @param {import("./schema.js").Kernel} kernel @returns {TracedText} */
export function tracedText({ shared, texts }, kernel) {
  const { trace } = kernel;
  if (!trace) throw failure("no-trace", `${kernel.name} has no traced text in this page.`);
  if ("lacks" in trace) throw failure("no-trace", trace.lacks);
  if (refused.has(trace)) throw failure("lost", kernel.name);
  const edited = trace.files.find((file) => texts[file] !== undefined && texts[file] !== shared.files[file]);
  if (edited) throw failure("edited", edited);
  return trace;
}

/** @param {TracedText} trace @returns {import("./trace_values.js").Place[]} */
const placesOf = ({ places, files }) =>
  places.map(([kind, name, own, type, file, line, endLine, loops]) =>
    ({ kind, name, function: own, type, file: files[file], line, endLine, loops }));

/** @param {Engine} engine @param {Player} player @param {Job} job @param {Result | null} before
 *  @param {number} iteration @param {[number, number]} texel @param {ArrayBufferView[]} real
 *  @returns {Omit<Trace, "iteration" | "total">} */
function drawn(engine, player, job, before, iteration, texel, real) {
  const { context, programs } = engine.parts, { step, text } = job, { kernel } = step;
  const trace = tracedText(player, kernel);
  if (kernel.outputs.length + 2 > context.limits.outputs) {
    const most = `this device has ${context.limits.outputs}`;
    throw failure("no-trace", `A trace needs ${kernel.outputs.length + 2} outputs of a shader; ${most}.`);
  }
  const vertex = stagesOf(text, new Map(), "").texts[0];
  const program = programs.ask([vertex, toES(trace.text, { extensions: kernel.extensions })]);
  if (!programs.finish(program)) {
    const log = [...program.logs, program.link].join("").trim().split("\n")[0];
    if (log) throw failure("no-trace", `This device does not take the traced text: ${log}`);
    refused.add(trace);
    throw failure("lost", kernel.name);
  }
  bind(engine, program, job, before, iteration);
  let target = recorded(engine, program, job, trace, texel, ROWS);
  const rows = Math.ceil(target.count / WIDTH);
  if (rows > ROWS) target = recorded(engine, program, job, trace, texel, Math.min(rows, MAX_ROWS));
  try {
    context.check(`the trace of '${step.path}'`);
  } catch (error) {
    if (/** @type {import("./context.js").Failure} */ (error).code !== "context-lost") throw error;
    refused.add(trace);
    throw failure("lost", kernel.name);
  }
  return {
    path: step.path, texel, kernel, run: rebuild(placesOf(trace), trace.structs, target.leaves),
    isComplete: target.leaves.length >= target.count,
    isExact: target.outputs.every((own, i) => isSame(own, real[i])),
    outputs: target.outputs.map((own) => Array.from(/** @type {any} */ (own))),
  };
}

/** Set all that the text is given: a traced text is run as the real one.
 *  @param {Engine} engine @param {import("./programs.js").Program} program @param {Job} job
 *  @param {Result | null} before @param {number} iteration */
function bind(engine, program, job, before, iteration) {
  const { context: { gl }, binder, kernels, plain } = engine.parts, { step, time } = job, { kernel } = step;
  if (kernel.kind === "plain_fragment") return plain.prepare(program, job);
  let unit = binder.bind(program, job, kernels.readsOf(job));
  for (const { name } of kernel.outputs) {
    const read = before?.textures.get(name) ?? binder.constant("zero");
    if (program.uniforms.has(`k_previous_${name}`))
      unit = binder.texture(program, `k_previous_${name}`, unit, read, PLAIN);
  }
  // The texels of what came before are all in their places, so a lattice is none here.
  kernels.count(program, job, iteration, Math.max(whole(kernel.atOnce ?? 1, headerNames(step, time)), 1));
  setUniform(gl, program, "k_previous_shift", 0);
  setUniform(gl, program, "k_shift", 0);
  return undefined;
}

/** Draw into a target of so many rows, and read it.
 *  @param {Engine} engine @param {import("./programs.js").Program} program @param {Job} job
 *  @param {TracedText} trace @param {[number, number]} texel @param {number} rows */
function recorded(engine, program, { step: { kernel } }, { quads }, texel, rows) {
  const { context, textures } = engine.parts, { gl, make, drop } = context, scale = quads ? 2 : 1;
  const size = /** @type {[number, number]} */ ([WIDTH * scale, rows * scale]);
  const own = kernel.outputs.map(({ format }) => textures.texture(size, format));
  const bits = [0, 1].map(() => {
    const texture = make("Texture");
    gl.activeTexture(gl.TEXTURE0 + context.limits.spare);
    gl.bindTexture(gl.TEXTURE_2D, texture);
    gl.texStorage2D(gl.TEXTURE_2D, 1, gl.RGBA32UI, ...size);
    return texture;
  });
  const target = make("Framebuffer"), all = [...own.map(({ texture }) => texture), ...bits];
  gl.bindFramebuffer(gl.FRAMEBUFFER, target);
  const places = all.map((_, i) => gl.COLOR_ATTACHMENT0 + i);
  try {
    all.forEach((texture, i) =>
      gl.framebufferTexture2D(gl.FRAMEBUFFER, places[i], gl.TEXTURE_2D, texture, 0));
    gl.drawBuffers(places);
    if (gl.checkFramebufferStatus(gl.FRAMEBUFFER) !== gl.FRAMEBUFFER_COMPLETE && !gl.isContextLost())
      throw failure("no-trace", "This device cannot draw a trace: its outputs are of two kinds.");
    setUniform(gl, program, "k_trace_texel", texel);
    setUniform(gl, program, "k_trace_width", WIDTH);
    setUniform(gl, program, "k_trace_from", 0);
    gl.viewport(0, 0, ...size);
    gl.bindVertexArray(null);
    gl.drawArrays(gl.TRIANGLES, 0, 3);
    const [what, values] = [1, 0].map((which) => {
      const read = new Uint32Array(4 * size[0] * size[1]);
      gl.readBuffer(places[own.length + which]);
      gl.readPixels(0, 0, ...size, gl.RGBA_INTEGER, gl.UNSIGNED_INT, read);
      return read;
    });
    const [right, up] = quads ? [texel[0] & 1, texel[1] & 1] : [0, 0];
    /** @param {number} index of an event */
    const place = (index) =>
      4 * ((Math.floor(index / WIDTH) * scale + up) * size[0] + (index % WIDTH) * scale + right);
    const count = what[place(0) + 2], leaves = [];
    for (let index = 0; index < Math.min(count, WIDTH * rows); index++) {
      const at = place(index);
      leaves.push({ place: what[at], code: what[at + 1], bits: values.subarray(at, at + 4) });
    }
    const outputs = own.map((texture, i) => {
      gl.readBuffer(places[i]);
      return texelOf(engine, texture, [right, up]);
    });
    return { count, leaves, outputs };
  } finally {
    gl.bindFramebuffer(gl.FRAMEBUFFER, null);
    drop("Framebuffer", target);
    own.forEach(textures.release);
    bits.forEach((texture) => drop("Texture", texture));
  }
}

/** Return what a texel of each of a pass's textures holds. @param {Engine} engine @param {Result} result
 *  @param {[number, number]} texel */
function texelsAt(engine, result, texel) {
  const { context: { gl }, textures } = engine.parts;
  return [...result.textures.values()].map((texture) => {
    gl.bindFramebuffer(gl.FRAMEBUFFER, textures.targetOf(texture));
    return texelOf(engine, texture, texel);
  });
}

/** Return what a texel of the attachment that is read holds, as it is stored.
 *  @param {Engine} engine @param {import("./textures.js").Texture} texture @param {[number, number]} texel */
function texelOf(engine, texture, [x, y]) {
  const { context: { gl }, textures } = engine.parts, { type, channels } = textures.formats(texture.format);
  const normalised = type === gl.UNSIGNED_BYTE || type === gl.UNSIGNED_SHORT;
  const read = new (normalised ? HELD[type] : Float32Array)(4);
  gl.readPixels(x, y, 1, 1, gl.RGBA, normalised ? type : gl.FLOAT, read);
  return read.subarray(0, channels);
}

/** Whether two texels have the same bits. @param {ArrayBufferView} one @param {ArrayBufferView} other */
function isSame(one, other) {
  const [a, b] = [one, other].map((each) => new Uint8Array(each.buffer, each.byteOffset, each.byteLength));
  return a.length === b.length && a.every((byte, at) => byte === b[at]);
}
