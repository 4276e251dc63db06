"""Shaders of glslCanvas', glslViewer's, Bonzomatic's, KodeLife's and glslsandbox' kinds, for these tests.

One for each rule and for some that meet. ``// here`` is a line at which a mistake may be planted.
"""

from __future__ import annotations

BOOK = (
    "#ifdef GL_ES\nprecision mediump float;\n#endif\n\nuniform vec2 u_resolution;\nuniform float u_time;\n\n"
)

MAIN_TEXTS: dict[str, str] = {
    # The Book of Shaders and glslCanvas
    "book_functions": BOOK
    + """float plot(vec2 st, float pct) {
    return smoothstep(pct - 0.02, pct, st.y) - smoothstep(pct, pct + 0.02, st.y);
}
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
    float y = 0.5 + 0.4 * sin(st.x * 6.28318 + u_time);
    // here
    vec3 color = mix(vec3(y), vec3(0.0, 1.0, 0.0), plot(st, y));
    gl_FragColor = vec4(color, 1.0);
}
""",
    "book_noise": BOOK
    + """float random(in vec2 st) { return fract(sin(dot(st.xy, vec2(12.9898, 78.233))) * 43758.5453123); }
float noise(in vec2 st) {
    vec2 i = floor(st), f = fract(st);
    vec2 u = f * f * (3.0 - 2.0 * f);
    return mix(mix(random(i), random(i + vec2(1.0, 0.0)), u.x),
               mix(random(i + vec2(0.0, 1.0)), random(i + vec2(1.0, 1.0)), u.x), u.y);
}
#define OCTAVES 6
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution.xy * 3.0;
    float value = 0.0, amplitude = 0.5;
    // here
    for (int i = 0; i < OCTAVES; i++) {
        value += amplitude * noise(st + u_time);
        st *= 2.0;
        amplitude *= 0.5;
    }
    gl_FragColor = vec4(vec3(value), 1.0);
}
""",
    "book_matrix": BOOK
    + """mat2 rotate2d(float angle) { return mat2(cos(angle), -sin(angle), sin(angle), cos(angle)); }
float box(in vec2 st, in vec2 size) {
    size = vec2(0.5) - size * 0.5;
    vec2 uv = smoothstep(size, size + vec2(0.001), st);
    uv *= smoothstep(size, size + vec2(0.001), vec2(1.0) - st);
    return uv.x * uv.y;
}
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution.xy;
    st = rotate2d(sin(u_time) * 3.14159) * (st - 0.5) + 0.5;
    // here
    gl_FragColor = vec4(vec3(st, 0.0) + box(st, vec2(0.4, 0.1)), 1.0);
}
""",
    "canvas_textures": BOOK
    + """uniform sampler2D u_tex0;
uniform sampler2D u_tex1;
uniform vec2 u_tex0Resolution, u_tex1Resolution;
varying vec2 v_texcoord;
void main() {
    vec2 st = v_texcoord;
    // here
    float aspect = u_tex0Resolution.x / u_tex1Resolution.y;
    gl_FragColor = mix(texture2D(u_tex0, st), texture2D(u_tex1, st * aspect), 0.5 + 0.5 * sin(u_time));
}
""",
    "canvas_date_mouse": BOOK
    + """uniform vec2 u_mouse;
uniform vec4 u_date;
uniform float u_delta;
uniform int u_frame;
void main() {
    // here
    float more = u_date.x * 0.0 + u_delta + float(u_frame) * 0.001;
    gl_FragColor = vec4(abs(gl_FragCoord.xy - u_mouse) / u_resolution, fract(more), 1.0);
}
""",
    "canvas_backbuffer": BOOK
    + """uniform sampler2D u_backbuffer;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
    // here
    gl_FragColor = mix(texture2D(u_backbuffer, st), vec4(st, fract(u_time), 1.0), 0.1);
}
""",
    # glslViewer
    "viewer_buffers": BOOK
    + """uniform sampler2D u_buffer0; // 0.5
uniform sampler2D u_buffer1; // 16x16
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
    vec4 color = vec4(0.0, 0.0, 0.0, 1.0);
#if defined(BUFFER_0)
    color.rg = st;
#elif defined(BUFFER_1)
    // here
    color = texture2D(u_buffer0, st) + fract(u_time);
#else
    color = texture2D(u_buffer1, st.yx);
#endif
    gl_FragColor = color;
}
""",
    "viewer_ripples": BOOK
    + """uniform sampler2D u_doubleBuffer0;
uniform vec2 u_mouse;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
    vec2 pixel = 1.0 / u_resolution;
#ifdef DOUBLE_BUFFER_0
    vec2 here = texture2D(u_doubleBuffer0, st).rg;
    float around = texture2D(u_doubleBuffer0, st + vec2(pixel.x, 0.0)).r
                 + texture2D(u_doubleBuffer0, st - vec2(pixel.x, 0.0)).r
                 + texture2D(u_doubleBuffer0, st + vec2(0.0, pixel.y)).r
                 + texture2D(u_doubleBuffer0, st - vec2(0.0, pixel.y)).r;
    // here
    float drop = smoothstep(0.1, 0.0, distance(st, vec2(0.3, 0.6))) * sin(u_time * 20.0) * 0.2;
    gl_FragColor = vec4((around * 0.5 - here.g) * 0.99 + drop, here.r, 0.0, 1.0);
#else
    gl_FragColor = vec4(0.5 + 0.5 * texture2D(u_doubleBuffer0, st).rrr, 1.0);
#endif
}
""",
    "viewer_two_states": BOOK
    + """uniform sampler2D u_doubleBuffer0; // 8x8
uniform sampler2D u_doubleBuffer1; // 0.5
uniform sampler2D u_buffer0;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined(BUFFER_0)
    gl_FragColor = texture2D(u_doubleBuffer1, st);
#elif defined( DOUBLE_BUFFER_0 )
    // here
    gl_FragColor = mix(texture2D(u_doubleBuffer0, st), vec4(st, 0.5, 1.0), 0.2);
#elif defined(DOUBLE_BUFFER_1)
    gl_FragColor = mix(texture2D(u_doubleBuffer1, st), texture2D(u_doubleBuffer0, st), 0.3);
#else
    gl_FragColor = texture2D(u_buffer0, st) + texture2D(u_doubleBuffer1, st) * 0.5;
#endif
}
""",
    "viewer_pyramid": BOOK
    + """uniform sampler2D u_pyramid0;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined(PYRAMID_0)
    // here
    bool dot_here = mod(floor(gl_FragCoord.xy), 6.0) == vec2(3.0);
    gl_FragColor = dot_here ? vec4(st, 0.5 + 0.5 * sin(u_time), 1.0) : vec4(0.0);
#else
    gl_FragColor = texture2D(u_pyramid0, st);
#endif
}
""",
    "viewer_pyramid_old": BOOK
    + """uniform sampler2D u_convolutionPyramid;
uniform sampler2D u_convolutionPyramidTex0;
uniform sampler2D u_convolutionPyramidTex1;
uniform bool u_convolutionPyramidUpscaling;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined(CONVOLUTION_PYRAMID)
    gl_FragColor = vec4(st, 0.0, 1.0);
#elif defined(CONVOLUTION_PYRAMID_ALGORITHM)
    // here
    if (u_convolutionPyramidUpscaling)
        gl_FragColor = texture2D(u_convolutionPyramidTex0, st) * 0.5
                     + texture2D(u_convolutionPyramidTex1, st) * 0.5;
    else
        gl_FragColor = texture2D(u_convolutionPyramidTex0, st) * 0.9;
#else
    gl_FragColor = texture2D(u_convolutionPyramid, st);
#endif
}
""",
    "viewer_flood": BOOK
    + """uniform sampler2D u_flood0;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined(FLOOD_0)
    // here
    gl_FragColor = abs(distance(st, vec2(0.5)) - 0.3) < 0.05 ? vec4(st, 0.0, 1.0) : vec4(0.0);
#else
    gl_FragColor = vec4(vec3(distance(texture2D(u_flood0, st).xy, st) * 2.0), 1.0);
#endif
}
""",
    "viewer_post": BOOK
    + """uniform sampler2D u_scene;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined(BACKGROUND)
    gl_FragColor = vec4(st, 0.5, 1.0);
#elif defined(POSTPROCESSING)
    // here
    st.x += sin(st.y * 20.0 + u_time) * 0.05;
    gl_FragColor = texture2D(u_scene, st);
#else
    gl_FragColor = vec4(1.0);
#endif
}
""",
    "viewer_conditions": BOOK
    + """#define QUALITY 2
#define HIGH (QUALITY > 1)
uniform sampler2D u_buffer0;
uniform sampler2D u_buffer1;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined(BUFFER_0) || (defined(BUFFER_1) && !defined(NEVER))
#   if HIGH && defined(BUFFER_1)
    // here
    gl_FragColor = texture2D(u_buffer0, st) * 0.5;
#   else
    gl_FragColor = vec4(st, fract(u_time), 1.0);
#   endif
#else
    gl_FragColor = texture2D(u_buffer1, st) + texture2D(u_buffer0, st) * 0.25;
#endif
}
""",
    "viewer_scene_names": BOOK
    + """uniform vec3 u_camera, u_light, u_lightColor;
uniform mat4 u_modelMatrix, u_viewMatrix, u_projectionMatrix;
uniform mat3 u_normalMatrix;
varying vec3 v_normal;
varying vec4 v_position;
varying vec2 v_texcoord;
#ifdef MODEL_VERTEX_TANGENT
varying mat3 v_tangentToWorld;
#endif
void main() {
    vec3 n = normalize(u_normalMatrix * v_normal);
    // here
    float shade = dot(n, normalize(u_light)) * u_lightColor.r + u_camera.x * 0.0;
    gl_FragColor = vec4(v_texcoord * shade, 0.5 + 0.5 * v_position.x, 1.0);
}
""",
    # glslsandbox
    "sandbox_trails": """#extension GL_OES_standard_derivatives : enable
precision highp float;
uniform float time;
uniform vec2 mouse;
uniform vec2 resolution;
uniform sampler2D backbuffer;
void main(void) {
    vec2 p = gl_FragCoord.xy / resolution.xy;
    vec3 old = texture2D(backbuffer, p).rgb * 0.9;
    // here
    float spot = smoothstep(0.1, 0.0, distance(p, vec2(0.5 + 0.3 * cos(time), 0.5 + 0.3 * sin(time))));
    gl_FragColor = vec4(max(old, vec3(spot, spot * p)), 1.0);
}
""",
    "sandbox_surface": """precision mediump float;
uniform float time;
varying vec2 surfacePosition;
void main(void) {
    float a = atan(surfacePosition.y, surfacePosition.x);
    // here
    gl_FragColor = vec4(vec3(sin(a * 8.0 + time), cos(length(surfacePosition) * 9.0), 0.5), 1.0);
}
""",
    # Bonzomatic
    "bonzomatic_previous": """#version 410 core
uniform float fGlobalTime;
uniform vec2 v2Resolution;
uniform sampler2D texPreviousFrame;
uniform sampler1D texFFTSmoothed;
uniform sampler1D texFFTIntegrated;
layout(location = 0) out vec4 out_color;
vec4 plas(vec2 v, float time) {
    float c = 0.5 + sin(v.x * 10.0) + cos(sin(time + v.y) * 20.0);
    return vec4(sin(c * 0.2 + cos(time)), c * 0.15, cos(c * 0.1 + time / .4) * .25, 1.0);
}
void main(void) {
    vec2 uv = vec2(gl_FragCoord.x / v2Resolution.x, gl_FragCoord.y / v2Resolution.y);
    float f = texture(texFFTSmoothed, 0.1).r + texture(texFFTIntegrated, 0.2).r;
    // here
    out_color = mix(plas(uv, fGlobalTime) + f, texture(texPreviousFrame, uv * 0.99), 0.5);
}
""",
    "bonzomatic_textures": """#version 410 core
uniform float fGlobalTime;
uniform vec2 v2Resolution;
uniform float fFrameTime;
uniform sampler2D texChecker, texNoise, texTex1, texTex2, texTex3, texTex4;
layout(location = 0) out vec4 out_color;
void main(void) {
    vec2 uv = gl_FragCoord.xy / v2Resolution;
    vec4 sum = texture(texChecker, uv) + texture(texNoise, uv) + texture(texTex1, uv) + texture(texTex2, uv);
    // here
    out_color = (sum + texture(texTex3, uv) + texture(texTex4, uv)) / 6.0 + fFrameTime * fract(fGlobalTime);
}
""",
    # KodeLife
    "kodelife_frames": """#version 150
uniform float time;
uniform vec2 resolution;
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
    vec2 uv = inData.v_texcoord;
    // here
    fragColor = vec4(uv, 0.5 + 0.5 * sin(time), 1.0) * 0.2 + texture(prevFrame, uv) * 0.4;
    fragColor += texture(prevPass, uv.yx) * 0.2;
}
""",
    "kodelife_es": """#version 300 es
precision highp float;
uniform float time;
uniform vec2 resolution;
uniform vec3 spectrum;
uniform sampler2D texture0;
in VertexData { vec4 v_position; vec3 v_normal; vec2 v_texcoord; } inData;
out vec4 fragColor;
void main(void) {
    vec2 uv = -1.0 + 2.0 * inData.v_texcoord;
    // here
    fragColor = vec4(abs(uv), 0.5 + 0.5 * sin(time), 1.0) + texture(texture0, uv) * 0.2 + spectrum.x * 0.1;
}
""",
    # Older built-ins, our own names, arrays of samplers, macros over lines
    "tex_coord": """#version 120
uniform sampler2D u_tex0;
void main() {
    vec4 a = texture2D(u_tex0, gl_TexCoord[0].st) * gl_Color;
    // here
    gl_FragColor = a + vec4(gl_TexCoord[1].xy, gl_FogFragCoord, 0.0) * 0.5 + gl_SecondaryColor;
}
""",
    "our_names": """uniform vec2 u_resolution;
uniform float k_window = 0.5;
varying vec2 k_share;
vec3 k_frag_color = vec3(0.25);
float k_part(float k_place) { return k_place * 2.0; }
void main() {
    vec2 k_picture = gl_FragCoord.xy / u_resolution;
    // here
    gl_FragColor = vec4(k_picture * k_part(k_window), k_share.x * 0.0 + k_frag_color.b, 1.0);
}
""",
    "sampler_array": """uniform vec2 u_resolution;
uniform sampler2D maps[3];
uniform sampler2D u_tex0;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
    // here
    gl_FragColor = texture2D(u_tex0, st) + texture2D(maps[0], st) + texture2D(maps[2], st);
}
""",
    "macro_over_lines": """uniform vec2 u_resolution;
uniform sampler2D u_tex1;
#define BLEND(a, b, t) mix(a, b, t)
#define MIX BLEND
#define READ(s, p) texture2D(s, \\
                             p)
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
    vec3 c = MIX(
        vec3(st, 0.0),  // the first
        BLEND(vec3(1.0,
                   0.5, 0.0),
              READ(u_tex1,
                   st).rgb,
              0.5),
        st.x);
    // here
    gl_FragColor = vec4(c, 1.0);
}
""",
    "macro_in_a_pass": BOOK
    + """#define PICK(a, b) (a + b)
uniform sampler2D u_buffer0;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#ifdef BUFFER_0
    gl_FragColor = PICK(vec4(st, 0.0, 0.5),
                        vec4(0.0,
                             0.0, 0.5, 0.5));
    // here
    gl_FragColor.b = fract(u_time);
#else
    gl_FragColor = texture2D(
        u_buffer0, st);
#endif
}
""",
    "version_330_passes": """#version 330
uniform vec2 u_resolution;
uniform float u_time;
uniform sampler2D u_buffer0;
out vec4 fragColor;
void main() {
    vec2 st = gl_FragCoord.xy / u_resolution;
#if defined(BUFFER_0)
    // here
    fragColor = vec4(st, sin(u_time), 1.0);
#else
    fragColor = texture(u_buffer0, st).bgra;
#endif
}
""",
}

STATEFUL = {
    "canvas_backbuffer",
    "viewer_ripples",
    "viewer_two_states",
    "sandbox_trails",
    "bonzomatic_previous",
    "kodelife_frames",
}
"""Those that read what was drawn in the frame before."""
