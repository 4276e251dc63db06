// settling.js -- finds out whether a step of a repeat changed any texel: playground/engine/kernels.py.
//
// After n steps the next comparison is about √n steps away, since its answer is waited for.

import { PLAIN } from "./binder.js";
import { setUniform } from "./programs.js";

/** @typedef {import("./textures.js").Result} Result */

const BLOCK = 8; // texels a side that one fragment compares
const CHANGED = [{ name: "k_changed", format: "r8" }];

/** @param {WebGL2RenderingContext} gl @param {import("./textures.js").Textures} textures
 *  @param {import("./binder.js").Binder} binder @param {() => void} fill
 *  @param {() => import("./programs.js").Program} programOf of changed.frag */
export const createSettling = (gl, textures, binder, fill, programOf) => {
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
