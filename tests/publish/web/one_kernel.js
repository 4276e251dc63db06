// one_kernel.js -- a player of one kernel, for tests of the editor: compiled and drawn by WebGL itself.

import { complaints } from "../../../playground/publish/web/runtime/complaints.js";
import { libraryOf } from "../../../playground/publish/web/runtime/complaints.js";
import { finished } from "../../../playground/publish/web/runtime/context.js";

export { EDITOR_WORDS } from "../../../playground/publish/web/runtime/editor_words.js";
export { createEditor } from "../../../playground/publish/web/runtime/editor.js";
export { createGuard, keyOf } from "../../../playground/publish/web/runtime/recovery.js";
export { createRecovery } from "../../../playground/publish/web/runtime/recovery.js";

const HEAD = ["#version 300 es", "precision highp float; precision highp int; uniform float level;"];
const TAIL = "out vec4 k_out; void main() { k_out = vec4(kernel(ivec2(gl_FragCoord.xy)), 0.25, 0.5, 1.0); }";
const CORNERS = "#version 300 es\nvoid main() { vec2 at = vec2(gl_VertexID & 1, gl_VertexID >> 1);"
    + " gl_Position = vec4(4.0 * at - 1.0, 0.0, 1.0); }";

/** The kernel's lines with its includes in place, comments and pragmas blanked. */
function flatten(file, textOf, out = []) {
    textOf(file).split("\n").forEach((raw, at) => {
        const include = /^\s*#include "([^"]+)"/.exec(raw);
        const blank = include || /^\s*#\s*pragma/.test(raw);
        out.push({ code: blank ? "" : raw.replace(/\/\/.*/, ""), file, line: at + 1 });
        if (include) flatten(`./${include[1]}`, textOf, out);
    });
    return out;
}

/** Make a player of "./k.glsl" on a canvas. */
export function createPlayer(canvas, files) {
    let gl, program;
    const player = {
        sketch: { name: "one", kernels: [{ name: "k", file: "./k.glsl" }], nodes: [{ path: "k", kernel: 0 }], tracks: [] },
        shared: { files, includes: { "./k.glsl": { "waves.glsl": "./waves.glsl" } } },
        state: { frame: [canvas.width, canvas.height], terrain: { size: [65, 65] } },
        texts: {},
        edits: 0,
        open() {
            gl = canvas.getContext("webgl2", { preserveDrawingBuffer: true });
            program = made({ ...files, ...player.texts }).program;
            player.render();
        },
        async edit(file, text) {
            player.edits++;
            const texts = { ...player.texts, [file]: text };
            if (text === files[file]) delete texts[file];
            const found = made({ ...files, ...texts });
            if (found.program) [program, player.texts] = [found.program, texts];
            return { errors: found.errors, programs: found.program ? 1 : 0 };
        },
        render() {
            gl.viewport(0, 0, ...player.state.frame);
            gl.useProgram(program);
            gl.uniform1f(gl.getUniformLocation(program, "level"), 0.5);
            gl.drawArrays(gl.TRIANGLES, 0, 3);
        },
        done: () => finished(gl),
        pixel() {
            const found = new Uint8Array(4);
            gl.readPixels(0, 0, 1, 1, gl.RGBA, gl.UNSIGNED_BYTE, found);
            return [...found];
        },
        get gl() { return gl; },
    };

    function made(texts) {
        const lines = flatten("./k.glsl", (name) => texts[name]);
        const code = lines.map((line) => line.code.replace(/^\s*uniform float level[^;]*;/, ""));
        const about = {
            first: HEAD.length + 1, lines, file: "./k.glsl", kernel: "k", expected: "float kernel(ivec2 texel)",
            text: (name) => texts[name], library: libraryOf(files),
        };
        const linked = gl.createProgram();
        for (const [type, text] of [[gl.VERTEX_SHADER, CORNERS], [gl.FRAGMENT_SHADER, [...HEAD, ...code, TAIL].join("\n")]]) {
            const shader = gl.createShader(type);
            gl.shaderSource(shader, text);
            gl.compileShader(shader);
            if (!gl.getShaderParameter(shader, gl.COMPILE_STATUS)) {
                return { errors: complaints(gl.getShaderInfoLog(shader), about) };
            }
            gl.attachShader(linked, shader);
        }
        gl.linkProgram(linked);
        return { program: linked, errors: [] };
    }

    return player;
}
