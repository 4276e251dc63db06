"""ISF shaders written for these tests: one for each rule of the format, and some that combine several.

``HERE`` is a line at which a mistake may be planted. ``VERTEX`` has the vertex shaders, by the same name.
"""

from __future__ import annotations

from tests.dialect_texts import HERE, MISTAKE, with_mistake

__all__ = ["HERE", "MISTAKE", "STATEFUL", "TEXTS", "VERTEX", "with_mistake"]

_GIVEN = """/*{"ISFVSN": "2", "DESCRIPTION": "All that ISF gives.", "CREDIT": "the tests", "INPUTS": []}*/
void main() {
    // here
    vec2 place = isf_FragNormCoord;
    float more = TIME + TIMEDELTA + float(FRAMEINDEX) * 0.01 + float(PASSINDEX) + DATE.x * 0.001;
    gl_FragColor = vec4(place, fract(more + gl_FragCoord.x / RENDERSIZE.x), 1.0);
}
"""

_TABS = """/*
{
	"DESCRIPTION": "Tabs	in a text, commas after the last, comments and short numbers",
	"CATEGORIES": ["Generator",],
	"INPUTS": [
		{
			"NAME": "level",  // how much
			"TYPE": "float",
			"MIN": .25, "MAX": 1., "DEFAULT": +.5,
		},
	],
}
*/
void main() {
    // here
    gl_FragColor = vec4(isf_FragNormCoord, level, 1.0);
}
"""

_INPUTS = """/*{
  "ISFVSN": "2",
  "INPUTS": [
    {"NAME": "level", "TYPE": "float", "DEFAULT": 0.5, "MIN": 0.0, "MAX": 1.0, "LABEL": "Level of red"},
    {"NAME": "on", "TYPE": "bool", "DEFAULT": 1},
    {"NAME": "go", "TYPE": "event"},
    {"NAME": "mode", "TYPE": "long", "VALUES": [1, 4, 9], "LABELS": ["one", "four", "nine"], "DEFAULT": 4},
    {"NAME": "centre", "TYPE": "point2D", "MIN": [-1, -1], "MAX": [1, 1], "DEFAULT": [0.25, 0]},
    {"NAME": "tint", "TYPE": "color", "DEFAULT": [1.0, 0.5, 0.25, 1.0]}
  ]
}*/
void main() {
    float near = 1.0 - distance(isf_FragNormCoord * 2.0 - 1.0, centre);
    // here
    vec4 found = on ? tint * near : vec4(level);
    gl_FragColor = vec4((go ? 1.0 - found : found).rgb * float(mode) / 4.0, 1.0);
}
"""

_FILTER = """/*{"ISFVSN": "2", "CATEGORIES": ["Filter"],
  "INPUTS": [{"NAME": "inputImage", "TYPE": "image"}]}*/
void main() {
    vec4 a = IMG_PIXEL(inputImage, gl_FragCoord.xy), b = IMG_NORM_PIXEL(inputImage, isf_FragNormCoord);
    vec4 c = IMG_THIS_PIXEL(inputImage), d = IMG_THIS_NORM_PIXEL(inputImage);
    // here
    vec2 size = IMG_SIZE(inputImage);
    gl_FragColor = (a + b + c + d) * 0.25 * (size == RENDERSIZE ? 1.0 : 0.0);
}
"""

_TRANSITION = """/*{
  "ISFVSN": "2",
  "INPUTS": [
    {"NAME": "startImage", "TYPE": "image"},
    {"NAME": "endImage", "TYPE": "image"},
    {"NAME": "progress", "TYPE": "float", "MIN": 0.0, "MAX": 1.0, "DEFAULT": 0.5}
  ]
}*/
void main() {
    // here
    gl_FragColor = mix(IMG_THIS_PIXEL(startImage), IMG_THIS_PIXEL(endImage),
                       step(isf_FragNormCoord.x, progress));
}
"""

_BIAS = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "inputImage", "TYPE": "image"}]}*/
#define source inputImage
#define read(i, p) IMG_NORM_PIXEL(i, p)
#define around(p, b) IMG_NORM_PIXEL(source, (p), b)
vec4 one(sampler2D some, vec2 p) { return IMG_NORM_PIXEL(some, p, 0.0); }
void main() {
    vec2 p = isf_FragNormCoord;
    // here
    vec4 sum = IMG_NORM_PIXEL(inputImage, mix(p, p.yx, max(0.1, min(p.x, 0.2))), 1.0);
    sum += IMG_PIXEL((source), (gl_FragCoord.xy + vec2(1.0, 0.0)), -1.0) + one(inputImage, p);
    gl_FragColor = (sum + read(source, abs(p)) + around(p + vec2(0.1), 0.5)) * 0.2;
}
"""

_PROPERTIES = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "inputImage", "TYPE": "image"}],
  "PASSES": [{"TARGET": "half_size", "WIDTH": "$WIDTH / 2"}, {}]}*/
void main() {
    vec2 place = gl_FragCoord.xy / _inputImage_imgSize;
    // here
    if (PASSINDEX == 0) { gl_FragColor = IMG_THIS_PIXEL(inputImage); return; }
    place.y = _inputImage_flip ? 1.0 - place.y : place.y;
    gl_FragColor = vec4(place, _half_size_imgRect.z / _inputImage_imgRect.z, 1.0);
}
"""

_VERSION_1 = """/*{
  "CREDIT": "by the tests",
  "CATEGORIES": ["Test"],
  "INPUTS": [{"NAME": "level", "TYPE": "float", "DEFAULT": 0.5}],
  "PERSISTENT_BUFFERS": ["kept"],
  "PASSES": [{"TARGET": "kept"}, {}]
}*/
void main() {
    // here
    if (PASSINDEX == 0)
        gl_FragColor = mix(IMG_THIS_PIXEL(kept), vec4(vv_FragNormCoord, level, 1.0), 0.5);
    else
        gl_FragColor = IMG_THIS_PIXEL(kept);
}
"""

_BUFFERS_1 = """/*{
  "INPUTS": [],
  "PERSISTENT_BUFFERS": {"kept": {"WIDTH": "$WIDTH / 2.0", "HEIGHT": "$HEIGHT / 2.0", "FLOAT": true}},
  "PASSES": [{"TARGET": "kept"}, {}]
}*/
void main() {
    // here
    if (PASSINDEX == 0) gl_FragColor = IMG_THIS_PIXEL(kept) + vec4(vv_FragNormCoord * 0.25, 0.0, 1.0);
    else gl_FragColor = IMG_NORM_PIXEL(kept, vv_FragNormCoord);
}
"""

_PASSES = """/*{
  "ISFVSN": "2",
  "INPUTS": [{"NAME": "inputImage", "TYPE": "image"},
             {"NAME": "blurAmount", "TYPE": "float", "DEFAULT": 2.0, "MIN": 1.0, "MAX": 8.0}],
  "PASSES": [
    {"TARGET": "across", "WIDTH": "floor($WIDTH / $blurAmount)", "HEIGHT": "$HEIGHT"},
    {"TARGET": "both", "WIDTH": "max($WIDTH / 4, 2)", "HEIGHT": "round($HEIGHT / 4.0)", "FLOAT": 1},
    {"DESCRIPTION": "the picture"}
  ]
}*/
void main() {
    vec2 p = isf_FragNormCoord;
    if (PASSINDEX == 0) {
        gl_FragColor = (IMG_NORM_PIXEL(inputImage, p) + IMG_NORM_PIXEL(inputImage, p + vec2(0.1, 0.0))) * 0.5;
    } else if (PASSINDEX == 1) {
        // here
        gl_FragColor = (IMG_NORM_PIXEL(across, p) + IMG_NORM_PIXEL(across, p + vec2(0.0, 0.1))) * 0.5;
    } else {
        gl_FragColor = IMG_NORM_PIXEL(both, p);
    }
}
"""

_RECURRING = """/*{
  "ISFVSN": "2", "INPUTS": [],
  "PASSES": [{"TARGET": "a"}, {"TARGET": "b"}, {"TARGET": "a"}, {"TARGET": "b"}, {"TARGET": "out"}]
}*/
void main() {
    // here
    vec4 before = PASSINDEX % 2 == 0 ? IMG_THIS_PIXEL(b) : IMG_THIS_PIXEL(a);
    gl_FragColor = before + vec4(isf_FragNormCoord * 0.2, 0.05, 1.0);
}
"""

_PERSISTENT = """/*{
  "ISFVSN": "2",
  "INPUTS": [{"NAME": "fade", "TYPE": "float", "DEFAULT": 0.9, "MIN": 0.0, "MAX": 1.0}],
  "PASSES": [{"TARGET": "trail", "PERSISTENT": true, "FLOAT": true}, {}]
}*/
void main() {
    if (PASSINDEX == 0) {
        vec2 at = 0.5 + 0.4 * vec2(cos(TIME * 3.0), sin(TIME * 3.0));
        // here
        float near = smoothstep(0.2, 0.0, distance(isf_FragNormCoord, at));
        gl_FragColor = vec4(IMG_THIS_PIXEL(trail).rgb * fade + near * vec3(1.0, 0.6, 0.2), 1.0);
    } else {
        gl_FragColor = IMG_THIS_PIXEL(trail);
    }
}
"""

_ONE_KEPT = """/*{"ISFVSN": "2", "INPUTS": [], "PASSES": [{"TARGET": "kept", "PERSISTENT": "true"}]}*/
void main() {
    // here
    vec4 seed = vec4(isf_FragNormCoord, 0.0, 1.0);
    gl_FragColor = FRAMEINDEX < 1 ? seed : mix(IMG_THIS_PIXEL(kept), seed.yxzw, 0.25);
}
"""

_WITH_VERTEX = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "inputImage", "TYPE": "image"},
  {"NAME": "amount", "TYPE": "float", "DEFAULT": 4.0, "MIN": 0.0, "MAX": 8.0}]}*/
varying vec2 left_coord;
varying vec2 right_coord;
void main() {
    // here
    vec4 edge = abs(IMG_NORM_PIXEL(inputImage, left_coord) - IMG_NORM_PIXEL(inputImage, right_coord));
    gl_FragColor = vec4(edge.rgb * amount + vec3(left_coord, 0.2), 1.0);
}
"""

_VERTEX = """varying vec2 left_coord;
varying vec2 right_coord;
void main() {
    isf_vertShaderInit();
    // here
    vec2 texel = amount / RENDERSIZE;
    left_coord = clamp(isf_FragNormCoord - vec2(texel.x, 0.0), 0.0, 1.0);
    right_coord = clamp(isf_FragNormCoord + vec2(texel.x, 0.0), 0.0, 1.0);
}
"""

_WITH_VERTEX_1 = """/*{"INPUTS": [{"NAME": "turn", "TYPE": "float", "DEFAULT": 0.5}]}*/
varying vec2 turned;
void main() {
    // here
    gl_FragColor = vec4(fract(turned * 2.0), vv_FragNormCoord.x, 1.0);
}
"""

_VERTEX_1 = """varying vec2 turned;
void main(void) {
    vv_vertShaderInit();
    // here
    turned = mat2(cos(turn), sin(turn), -sin(turn), cos(turn)) * vv_FragNormCoord;
}
"""

_WHOLE_AND_UNSIGNED = """/*{"ISFVSN": "2", "INPUTS": [
  {"NAME": "count", "TYPE": "long", "DEFAULT": 3, "MIN": 1, "MAX": 9}]}*/
float one() { return 1; }
void main() {
    uint cells = uint(gl_FragCoord.x);
    // here
    bool lit = cells % 4u == 0 || count > cells;
    gl_FragColor = vec4(lit ? one() : 0.25, isf_FragNormCoord, 1);
}
"""

_LONG_ALONE = """/*{"ISFVSN": "2", "INPUTS": [
  {"NAME": "a", "TYPE": "long", "LABELS": ["zero", "one"], "DEFAULT": 1},
  {"NAME": "b", "TYPE": "long", "VALUES": [2, 2, 7]},
  {"NAME": "c", "TYPE": "long"}]}*/
void main() {
    // here
    gl_FragColor = vec4(isf_FragNormCoord.x * float(a), float(b) * 0.25, float(c) + isf_FragNormCoord.y, 1.0);
}
"""

_NO_DEFAULTS = """/*{"ISFVSN": "2", "INPUTS": [
  {"NAME": "a", "TYPE": "float"}, {"NAME": "b", "TYPE": "float", "MIN": 2, "MAX": 4},
  {"NAME": "c", "TYPE": "bool"}, {"NAME": "d", "TYPE": "point2D"}, {"NAME": "e", "TYPE": "color"},
  {"NAME": "f", "TYPE": "float", "DEFAULT": 9, "MAX": 3}]}*/
void main() {
    // here
    gl_FragColor = e + vec4(a * isf_FragNormCoord.x, b / 8.0 * isf_FragNormCoord.y, c ? d.x : f, 1.0);
}
"""

_AUDIO = """/*{"ISFVSN": "2", "INPUTS": [
  {"NAME": "waveImage", "TYPE": "audio", "MAX": 64}, {"NAME": "fftImage", "TYPE": "audioFFT", "MAX": 16}]}*/
void main() {
    vec2 p = isf_FragNormCoord;
    // here
    float wave = IMG_NORM_PIXEL(waveImage, vec2(p.x, 0.5)).r, level = IMG_NORM_PIXEL(fftImage, p).r;
    float line = smoothstep(0.05, 0.0, abs(p.y - wave));
    gl_FragColor = vec4(step(p.y, level), line, IMG_SIZE(fftImage).x / 32.0, 1);
}
"""

_CUBE = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "around", "TYPE": "cube"}]}*/
void main() {
    // here
    vec4 sky = textureCube(around, vec3(isf_FragNormCoord - 0.5, 1.0));
    gl_FragColor = sky + vec4(isf_FragNormCoord, 0.0, 1.0);
}
"""

_IMPORTED = """/*{"ISFVSN": "2", "INPUTS": [], "IMPORTED": {"photo": {"PATH": "photo.png"}}}*/
void main() {
    // here
    gl_FragColor = IMG_NORM_PIXEL(photo, isf_FragNormCoord) + vec4(0.0, 0.0, IMG_SIZE(photo).x / 64.0, 0.0);
}
"""

_IMPORTED_1 = """/*{"INPUTS": [], "CREDIT": "", "IMPORTED": [{"NAME": "photo", "PATH": "./photo.png"}]}*/
void main() {
    // here
    gl_FragColor = IMG_NORM_PIXEL(photo, vv_FragNormCoord);
}
"""

_WORDS = """/*{"ISFVSN": "2", "INPUTS": [
  {"NAME": "filter", "TYPE": "float", "DEFAULT": 0.5}, {"NAME": "smooth", "TYPE": "bool"},
  {"NAME": "sample", "TYPE": "image"}, {"NAME": "mix", "TYPE": "float", "DEFAULT": 0.25}],
  "PASSES": [{"TARGET": "buffer", "WIDTH": "$WIDTH * $filter"}, {}]}*/
void main() {
    // here
    vec4 found = PASSINDEX == 0 ? IMG_THIS_PIXEL(sample) : IMG_THIS_PIXEL(buffer);
    gl_FragColor = smooth ? found * filter + mix : found;
}
"""

_DECLARES = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "level", "TYPE": "float", "DEFAULT": 0.5},
  {"NAME": "inputImage", "TYPE": "image"}]}*/
uniform float level;
uniform sampler2D inputImage;
uniform vec3 RENDERSIZE;
varying vec2 isf_FragNormCoord;
void main() {
    // here
    gl_FragColor = IMG_NORM_PIXEL(inputImage, gl_FragCoord.xy / RENDERSIZE.xy) * level + isf_FragNormCoord.x;
}
"""

_MACRO = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "inputImage", "TYPE": "image"}]}*/
#define MIXED(a, b, t) mix(IMG_NORM_PIXEL(inputImage, a), \\
                           IMG_NORM_PIXEL(inputImage, b), t)
void main() {
    gl_FragColor = MIXED(isf_FragNormCoord,
                         isf_FragNormCoord.yx,
                         0.5);
    // here
    gl_FragColor.a = 1.0;
}
"""

_INCLUDES = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "level", "TYPE": "float", "DEFAULT": 0.5}]}*/
#include "waves.glsl"
void main() {
    // here
    gl_FragColor = vec4(isf_FragNormCoord, wave(isf_FragNormCoord.x), 1.0);
}
"""

_DATA = """/*{"ISFVSN": "2", "INPUTS": []}*/
void main() {
    // here
    gl_FragData[0] = vec4(isf_FragNormCoord, 0.5, 1.0);
}
"""

_FUNCTION = """/*{"ISFVSN": "2", "INPUTS": [{"NAME": "inputImage", "TYPE": "image"}]}*/
vec3 blurred(sampler2D image, vec2 p, float r) {
    vec3 sum = vec3(0.0);
    for (int i = 0; i < 4; i++) sum += IMG_NORM_PIXEL(image, p + r * vec2(cos(float(i)), sin(float(i)))).rgb;
    return sum * 0.25;
}
void main() {
    // here
    gl_FragColor = vec4(blurred(inputImage, isf_FragNormCoord, 0.05), 1.0);
}
"""

_PIXELS_1 = """/*{"INPUTS": [{"NAME": "place", "TYPE": "point2D", "DEFAULT": [16, 9]}]}*/
void main() {
    // here
    gl_FragColor = vec4(vec3(1.0 - distance(gl_FragCoord.xy, place) / RENDERSIZE.x), 1.0);
}
"""

_SELF_READ = """/*{"ISFVSN": "2", "INPUTS": [], "PASSES": [{"TARGET": "later"}, {"TARGET": "first"}, {}]}*/
void main() {
    // here
    if (PASSINDEX == 0) gl_FragColor = IMG_THIS_PIXEL(first) + vec4(isf_FragNormCoord, 0.0, 1.0);
    else if (PASSINDEX == 1) gl_FragColor = vec4(1.0);
    else gl_FragColor = IMG_THIS_PIXEL(later);
}
"""

_GAME = """/*{
  "ISFVSN": "2", "CATEGORIES": ["Automata"],
  "INPUTS": [{"NAME": "restart", "TYPE": "event"}],
  "PASSES": [{"TARGET": "cells", "PERSISTENT": 1, "WIDTH": "$WIDTH / 2", "HEIGHT": "$HEIGHT / 2"}, {}]
}*/
float alive(vec2 at) { return step(0.5, IMG_PIXEL(cells, at).r); }
void main() {
    if (PASSINDEX == 1) { gl_FragColor = IMG_THIS_PIXEL(cells); return; }
    vec2 at = gl_FragCoord.xy;
    if (restart || FRAMEINDEX < 1) {
        float n = fract(sin(dot(floor(at), vec2(12.9898, 78.233))) * 43758.5453);
        gl_FragColor = vec4(vec3(step(0.6, n)), 1.0);
        return;
    }
    float around = -alive(at);
    for (int y = -1; y <= 1; y++)
        for (int x = -1; x <= 1; x++) around += alive(at + vec2(x, y));
    // here
    gl_FragColor = vec4(vec3(around == 3.0 || (around == 2.0 && alive(at) > 0.5) ? 1.0 : 0.0), 1.0);
}
"""

_VERSIONS = """/*{"CREDIT": "by the tests", "INPUTS": [{"NAME": "inputImage", "TYPE": "image"}]}*/
#if __VERSION__ <= 120
varying vec2 around[2];
#else
in vec2 around[2];
#endif
void main() {
    // here
    gl_FragColor = IMG_NORM_PIXEL(inputImage, around[0]) * 0.5 + IMG_NORM_PIXEL(inputImage, around[1]) * 0.5;
}
"""

_VERSIONS_VERTEX = """#if __VERSION__ <= 120
varying vec2 around[2];
#else
out vec2 around[2];
#endif
void main(void) {
    vv_vertShaderInit();
    // here
    around[0] = vv_FragNormCoord;
    around[1] = 1.0 - vv_FragNormCoord + 4.0 / IMG_SIZE(inputImage);
}
"""

_CONVERTED = """/*{"ISFVSN": "2", "CATEGORIES": ["Converted"],
  "INPUTS": [{"NAME": "iChannel0", "TYPE": "image"}, {"NAME": "iMouse", "TYPE": "point2D"}]}*/
#define iTime TIME
vec3 iResolution = vec3(RENDERSIZE, 1.0);
void mainImage(out vec4 fragColor, in vec2 fragCoord) {
    vec2 uv = fragCoord / iResolution.xy;
    // here
    fragColor = texture(iChannel0, uv + iMouse) * 0.5 + vec4(uv, fract(iTime), 1.0) * 0.5;
}
void main(void) { mainImage(gl_FragColor, gl_FragCoord.xy); }
"""

TEXTS: dict[str, str] = {
    "given": _GIVEN,
    "tabs": _TABS,
    "inputs": _INPUTS,
    "filter": _FILTER,
    "transition": _TRANSITION,
    "bias": _BIAS,
    "properties": _PROPERTIES,
    "version_1": _VERSION_1,
    "buffers_1": _BUFFERS_1,
    "passes": _PASSES,
    "recurring": _RECURRING,
    "persistent": _PERSISTENT,
    "one_kept": _ONE_KEPT,
    "with_vertex": _WITH_VERTEX,
    "with_vertex_1": _WITH_VERTEX_1,
    "whole_and_unsigned": _WHOLE_AND_UNSIGNED,
    "long_alone": _LONG_ALONE,
    "no_defaults": _NO_DEFAULTS,
    "audio": _AUDIO,
    "cube": _CUBE,
    "imported": _IMPORTED,
    "imported_1": _IMPORTED_1,
    "words": _WORDS,
    "declares": _DECLARES,
    "macro": _MACRO,
    "includes": _INCLUDES,
    "data": _DATA,
    "function": _FUNCTION,
    "pixels_1": _PIXELS_1,
    "self_read": _SELF_READ,
    "game": _GAME,
    "versions": _VERSIONS,
    "converted": _CONVERTED,
}

VERTEX = {"versions": _VERSIONS_VERTEX, "with_vertex": _VERTEX, "with_vertex_1": _VERTEX_1}

STATEFUL = ("version_1", "buffers_1", "persistent", "one_kept", "game")
"""Those whose picture depends on the frames before."""
