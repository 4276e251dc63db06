"""Shaders of other tools' kinds, written for these tests: one for each rule of the tables.

``HERE`` is a line at which a mistake may be planted.
"""

from __future__ import annotations

HERE = "    // here\n"
MISTAKE = "    float wrong = not_declared;\n"

TEXTS: dict[str, str] = {
    "book": """#ifdef GL_ES
precision mediump float;
#endif
uniform vec2 u_resolution;
uniform vec2 u_mouse;
uniform float u_time;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
    // here
    gl_FragColor = vec4(st, abs(sin(u_time + u_mouse.x)), 1.0);
}
""",
    "undeclared": """void main() {
    vec2 st = gl_FragCoord.xy / u_resolution.xy;
    // here
    gl_FragColor = vec4(st, fract(u_time) + float(u_frame) * 0.001 + u_delta + u_date.w, 1.0);
}
""",
    "varying": """precision highp float;
varying vec2 v_texcoord;
varying vec3 v_normal;
varying vec4 v_color;
varying vec2 surfacePosition;
void main() {
    // here
    gl_FragColor = vec4(v_texcoord, surfacePosition.x * 0.5 + 0.5, 1.0) * v_color * v_normal.z;
}
""",
    "data": """#extension GL_EXT_draw_buffers : enable
uniform vec2 resolution;
void main() {
    vec2 place = gl_FragCoord.xy / resolution;
    // here
    gl_FragData[1] = vec4(1.0, 0.0, 0.0, 1.0);
    gl_FragData[0] = vec4(place, 0.25, 1.0);
}
""",
    "depth": """#extension GL_EXT_frag_depth : enable
uniform vec2 resolution;
void main() {
    // here
    gl_FragDepthEXT = 0.5;
    gl_FragColor = vec4(gl_FragCoord.xy / resolution, 0.0, 1.0);
}
""",
    "lookups": """#pragma optimize(off)
#extension GL_EXT_shader_texture_lod : enable
uniform sampler2D texture;
uniform sampler2D u_tex1;
varying vec2 uv;
#define read(s, p) texture2D(s, p)
void main() {
    vec4 a = texture2D(u_tex1, uv) + texture2D(u_tex1, uv, 1.0) + read(texture, uv);
    // here
    vec4 b = texture2DLodEXT(u_tex1, uv, 2.0) + texture2DProj(u_tex1, vec3(uv, 1.0));
    b += texture2DProjLodEXT(u_tex1, vec4(uv, 0.0, 1.0), 0.0);
    b += texture2DGradEXT(u_tex1, uv, vec2(0.1), vec2(0.1));
    gl_FragColor = (a + b) * 0.2;
}
""",
    "words": """uniform vec2 u_resolution;
struct Ray { vec3 input; float common; };
#define active 0.5
float sample(float smooth) { return smooth * active; }
float layout(float a) { return a; }
void main() {
    float filter = 0.25, flat = 0.5, partition = 1.0;
    vec3 output = vec3(gl_FragCoord.xy / u_resolution, filter);
    Ray ray = Ray(output, flat);
    // here
    int uint = 1, switch = 2;
    vec3 all_of_it = ray.input * sample(layout(ray.common)) * 4.0 * partition;
    gl_FragColor = vec4(all_of_it / float(uint), float(switch));
}
""",
    "version_100": """#version 100
precision mediump float;
varying vec2 vUv;
void main() {
    // here
    gl_FragColor = vec4(vUv, 0.0, 1.0);
}
""",
    "version_120": """#version 120
varying vec2 vUv;
void main() {
    // here
    gl_FragColor = vec4(vUv, 0.0, 1.0);
}
""",
    "version_300_es": """#version 300 es
precision highp float;
precision highp sampler2D;
in highp vec2 vUv;
layout(location = 0) out vec4 colour;
void main() {
    // here
    colour = vec4(vUv, 0.5, 1.0);
}
""",
    "inputs": """#version 330
in vec2 coords[2], tex;
flat in int which;
in mat3 basis;
smooth in vec3 pos;
in Shared { vec4 colour; vec2 uv; } shared_in;
out vec4 colour;
void main() {
    // here
    colour = vec4(coords[1].x, tex.y, pos.x * 0.5 + 0.5, 1.0) * shared_in.colour * basis[0][0] + float(which);
    colour.b += shared_in.uv.x * 0.1;
}
""",
    "pack_420": """float one() { return 1; }
uniform vec2 u_resolution;
void main() {
    float half_of_it = 0.5;
    vec2 both = half_of_it.xx;
    // here
    gl_FragColor = vec4(gl_FragCoord.xy / u_resolution * both * 2.0, one(), one());
}
""",
    "macro": """uniform vec2 u_resolution;
#define BLEND(a, b, t) mix(a, b, t)
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
    vec3 c = BLEND(vec3(st, 0.0),
                   vec3(1.0,
                        0.5, 0.0),
                   st.x);
    // here
    gl_FragColor = vec4(c, 1.0);
}
""",
    "viewer": """uniform sampler2D u_tex0;
uniform sampler2D u_tex1;
uniform vec2 u_tex0Resolution;
uniform vec2 u_resolution;
uniform vec3 u_camera, u_light;
uniform vec3 u_SH[9];
uniform mat4 u_modelViewProjectionMatrix;
uniform mat3 u_view2d;
#ifndef GLSLVIEWER
#error no GLSLVIEWER
#endif
void main() {
    vec2 st = (u_view2d * vec3(gl_FragCoord.xy / u_resolution, 1.0)).xy;
    // here
    vec4 both = mix(texture2D(u_tex0, st), texture2D(u_tex1, st), 0.5) * u_tex0Resolution.x / 256.0;
    gl_FragColor = u_modelViewProjectionMatrix * both * u_camera.z * u_light.z + vec4(u_SH[8], 0.0);
}
""",
    "sandbox": """precision mediump float;
uniform float time;
uniform vec2 mouse;
uniform vec2 resolution;
uniform sampler2D backbuffer;
varying vec2 surfacePosition;
void main() {
    vec2 place = gl_FragCoord.xy / resolution;
    // here
    gl_FragColor = vec4(place, sin(time) * 0.5 + 0.5, 1.0) + texture2D(backbuffer, place + mouse);
}
""",
    "bonzomatic": """#version 410 core
uniform float fGlobalTime;
uniform vec2 v2Resolution;
uniform float fFrameTime;
uniform sampler1D texFFT;
uniform sampler2D texNoise;
uniform sampler2D texTex1;
uniform sampler2D texPreviousFrame;
layout(location = 0) out vec4 out_color;
void main(void) {
    vec2 uv = gl_FragCoord.xy / v2Resolution;
    // here
    out_color = vec4(uv, fract(fGlobalTime), 1.0) * 0.5;
    out_color += (texture(texNoise, uv) + texture(texTex1, uv)) * 0.2;
    out_color += vec4(texture(texFFT, uv.x).r) + texture(texPreviousFrame, uv) * 0.1 + fFrameTime;
}
""",
    "kodelife": """#version 150
uniform float time;
uniform vec2 resolution;
uniform vec2 mouse;
uniform vec3 spectrum;
uniform sampler2D texture0;
uniform sampler2D texture1;
uniform sampler2D texture2;
uniform sampler2D texture3;
uniform sampler2D prevFrame;
uniform sampler2D prevPass;
in VertexData
{
    vec4 v_position;
    vec3 v_normal;
    vec2 v_texcoord;
} inData;
out vec4 fragColor;
void main(void) {
    vec2 uv = -1. + 2. * inData.v_texcoord;
    // here
    vec4 some = texture(texture0, uv) + texture(texture1, uv);
    some += texture(texture2, uv) + texture(texture3, uv);
    fragColor = vec4(abs(uv), sin(time + mouse.x), 1.0) * 0.5 + some * 0.1;
    fragColor += vec4(spectrum, 0.0) * inData.v_normal.z;
    fragColor += texture(prevFrame, uv) * 0.1 + texture(prevPass, uv) * 0.1;
}
""",
    "toy": """// All that Shadertoy declares.
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    vec2 uv = fragCoord / iResolution.xy;
    // here
    vec4 four = texture(iChannel0, uv) + texture(iChannel1, uv);
    four += texture(iChannel2, uv) + texture(iChannel3, uv);
    float more = iTimeDelta + iFrameRate / 60.0 + iSampleRate / 44100.0 + float(iFrame) + iMouse.x + iDate.x;
    float sizes = iChannelResolution[0].x + iChannelResolution[3].y + iChannelTime[1] + iGlobalTime - iTime;
    fragColor = vec4(uv, 0.0, 0.0) * 0.5 + four * 0.1 + fract(more * 0.25 + sizes / 512.0) * 0.1;
}
""",
    "toy_old": """#define t iTime
vec3 tanh(vec3 a) { return a; }
void mainImage(out vec4 c, vec2 p) {
    float smooth = 0.5;
    // here
    c = texture2D(iChannel0, p / iResolution.xy) * smooth;
    c.rgb += tanh(vec3(fract(t), 0.0, p.x / iResolution.x)) * 0.5;
}
""",
    "toy_declares": """uniform vec2 iResolution;
uniform float iTime;
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    // here
    fragColor = vec4(fragCoord / iResolution, fract(iTime), 1.0);
}
""",
}


def with_mistake(text: str) -> tuple[str, int]:
    """Return a text with a mistake in it, and the mistake's line."""
    assert text.count(HERE) == 1
    return text.replace(HERE, MISTAKE), text[: text.index(HERE)].count("\n") + 1
