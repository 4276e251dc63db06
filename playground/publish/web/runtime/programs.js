// programs.js -- programs, compiled without waiting; one for each text, whoever asks for it.

/** @typedef {{at: WebGLUniformLocation, type: number, length: number}} Uniform */

/** @typedef {object} Program
 *  @property {WebGLProgram} program
 *  @property {WebGLShader[]} shaders           vertex and fragment, until it is linked
 *  @property {[string, string]} texts
 *  @property {Map<string, Uniform>} uniforms   those that the driver kept
 *  @property {Map<string, WebGLVertexArrayObject>} arrays   by mesh
 *  @property {"asked" | "ready" | "failed" | "gone"} state
 *  @property {[string, string]} logs           of its stages, where it failed
 *  @property {string} link                     the log of linking
 *  @property {number} used                     when it was used last
 *  @property {Map<string, {times: number, program: Program | null}>} chosen   by what is chosen: how often it
 *      was drawn so, and the program with that written in, once it is asked for */

/** @typedef {ReturnType<typeof createPrograms>} Programs */

const SPARE = 96; // programs kept beyond those that are in use

/** @param {import("./context.js").Context} context */
export const createPrograms = (context) => {
  const { gl, make, drop } = context;
  /** @type {Map<string, Program>} */
  const known = new Map();
  let clock = 0, compiled = 0;

  /** Begin to compile a program, unless it is known. @param {[string, string]} texts @returns {Program} */
  const ask = (texts) => {
    const key = texts.join("\0"), found = known.get(key);
    if (found) {
      found.used = ++clock;
      return found;
    }
    const program = make("Program"), shaders = texts.map((text, i) => {
      const shader = make("Shader", i ? gl.FRAGMENT_SHADER : gl.VERTEX_SHADER);
      gl.shaderSource(shader, text);
      gl.compileShader(shader);
      gl.attachShader(program, shader);
      return shader;
    });
    gl.linkProgram(program);
    compiled++;
    /** @type {Program} */
    const made = {
      program, shaders, texts, uniforms: new Map(), arrays: new Map(), state: "asked", logs: ["", ""],
      link: "", used: ++clock, chosen: new Map(),
    };
    known.set(key, made);
    return made;
  };

  /** @param {Program} program */
  const touch = (program) => { program.used = ++clock; };

  /** Whether a program can be used, or refused, without waiting for the driver. @param {Program} program */
  const isDone = (program) => {
    const { parallel } = context;
    if (program.state !== "asked" || gl.isContextLost()) return true;
    return !!parallel && gl.getProgramParameter(program.program, parallel.COMPLETION_STATUS_KHR);
  };

  /** Wait for a program; return whether it may be used. @param {Program} program */
  const finish = (program) => {
    if (program.state !== "asked") return program.state === "ready";
    const linked = gl.getProgramParameter(program.program, gl.LINK_STATUS);
    if (!linked) {
      const [vertex, fragment] = program.shaders.map((shader) => gl.getShaderInfoLog(shader) || "");
      program.logs = [vertex, fragment];
      program.link = gl.getProgramInfoLog(program.program) || "";
    }
    program.shaders.splice(0).forEach((shader) => {
      gl.detachShader(program.program, shader);
      drop("Shader", shader);
    });
    if (linked) lookAt(program);
    program.state = linked ? "ready" : "failed";
    return linked;
  };

  /** Wait until programs can be used or were refused, while the browser goes on.
   *  @param {Program[]} all @param {(done: number, total: number) => void} [onProgress] */
  const wait = async (all, onProgress = () => {}) => {
    const list = [...new Set(all)];
    for (;;) {
      const asked = list.filter((program) => program.state === "asked");
      const next = context.parallel ? asked.find(isDone) : asked[0];
      if (next) finish(next);
      const left = asked.length - (next ? 1 : 0);
      onProgress(list.length - left, list.length);
      if (!left) return;
      if (!next || !context.parallel) await new Promise((resume) => setTimeout(resume, next ? 0 : 5));
    }
  };

  /** @param {Program} program */
  const lookAt = ({ program, uniforms }) => {
    const many = gl.getProgramParameter(program, gl.ACTIVE_UNIFORMS);
    for (let i = 0; i < many; i++) {
      const { name, type, size } = /** @type {WebGLActiveInfo} */ (gl.getActiveUniform(program, i));
      const at = gl.getUniformLocation(program, name);
      if (at) uniforms.set(name.replace(/\[0\]$/, ""), { at, type, length: size });
    }
  };

  /** @param {Program} program */
  const release = (program) => {
    program.arrays.forEach((array) => drop("VertexArray", array));
    program.shaders.forEach((shader) => drop("Shader", shader));
    drop("Program", program.program);
    program.state = "gone";
    known.delete(program.texts.join("\0"));
  };

  /** Release programs that were used least recently, but those in use. @param {() => Set<Program>} inUse */
  const trim = (inUse) => {
    if (known.size <= SPARE) return;
    const used = inUse();
    const spare = [...known.values()].filter((each) => !used.has(each)).sort((a, b) => a.used - b.used);
    spare.splice(0, Math.max(spare.length - SPARE, 0)).forEach(release);
  };

  /** Release the vertex arrays made for a mesh. @param {string} mesh */
  const forgetMesh = (mesh) => known.forEach(({ arrays }) => {
    const array = arrays.get(mesh);
    if (array) drop("VertexArray", array);
    arrays.delete(mesh);
  });

  const clear = () => known.forEach(release);

  return {
    ask, touch, isDone, wait, finish, trim, release, forgetMesh, clear, get compiled() { return compiled; },
    get size() { return known.size; },
  };
};

/** Set a uniform, unless the driver dropped it; of several numbers as many as it has.
 *  @param {WebGL2RenderingContext} gl @param {Program} program @param {string} name
 *  @param {number | boolean | ArrayLike<number | boolean>} value */
export const setUniform = (gl, program, name, value) => {
  const uniform = program.uniforms.get(name);
  if (!uniform) return;
  const { at, type } = uniform;
  if (typeof value !== "object") {
    if (type === gl.FLOAT) gl.uniform1f(at, +value);
    else if (type === gl.UNSIGNED_INT) gl.uniform1ui(at, +value);
    else gl.uniform1i(at, +value);
    return;
  }
  const set = SETTERS[type] || "1iv", values = /** @type {any} */ (value);
  if (set.startsWith("Matrix")) /** @type {any} */ (gl)[`uniform${set}`](at, false, values);
  else /** @type {any} */ (gl)[`uniform${set}`](at, values);
};

/** By the type's number in WebGL; any other is set as whole numbers, one each.
 *  @type {Object<number, string>} */
const SETTERS = {
  0x1406: "1fv", 0x8b50: "2fv", 0x8b51: "3fv", 0x8b52: "4fv", 0x1405: "1uiv", 0x8dc6: "2uiv", 0x8dc7: "3uiv",
  0x8dc8: "4uiv", 0x8b53: "2iv", 0x8b54: "3iv", 0x8b55: "4iv", 0x8b57: "2iv", 0x8b58: "3iv", 0x8b59: "4iv",
  0x8b5a: "Matrix2fv", 0x8b5b: "Matrix3fv", 0x8b5c: "Matrix4fv",
};
