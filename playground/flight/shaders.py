"""The texts that draw a flight; what they work out stands in ``glsl/flight/scene.glsl``, with its tests."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import moderngl

AIRS = 64
"""Directions that the air's colour is worked out for."""

_VERSION = f"#version 330\nconst float AIRS = {AIRS}.0;\n"
_GIVEN = """
uniform sampler2D daylight;
uniform bool natural;
uniform vec3 zenith;
uniform vec3 horizon;
uniform float altitude;  // of the eye over the sea [km]
uniform float pixel;
uniform mat4 clip_from_near;
uniform mat4 near_from_clip;
"""
_SCREEN = """
out vec2 place;
void main() {
    place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
    gl_Position = vec4(place, 1.0, 1.0);  // farther than all land
}
"""
SKY = (
    _GIVEN
    + """
in vec2 place;
out vec4 frame;
void main() {
    vec4 away = near_from_clip * vec4(place, 1.0, 1.0);
    Backdrop sky = Backdrop(natural, zenith, horizon, altitude);
    frame = vec4(backdrop_towards(daylight, sky, normalize(away.xyz / away.w), pixel), 1.0);
}
"""
)
AIR = (
    _GIVEN
    + """
in vec2 place;
out vec4 frame;
void main() {
    // From what lies straight away from the sun to what lies towards it: the air depends on no more.
    vec2 sun = texelFetch(daylight, ivec2(0), 0).xy;
    sun = length(sun) > 1e-9 ? normalize(sun) : vec2(0.0, 1.0);
    float aside = (gl_FragCoord.x - 0.5) / (AIRS - 1.0) * 2.0 - 1.0;
    vec2 towards = aside * sun + sqrt(max(1.0 - aside * aside, 0.0)) * vec2(-sun.y, sun.x);
    Backdrop sky = Backdrop(natural, zenith, horizon, altitude);
    frame = vec4(air_between(daylight, sky, vec3(towards, 0.03)), 1.0);
}
"""
)
PRESENT = """
uniform sampler2D picture;
uniform float exposure;
uniform int tone;
uniform float white;
uniform bool plain;
out vec4 frame;
void main() {
    vec3 light = texelFetch(picture, ivec2(gl_FragCoord.xy), 0).rgb;
    frame = vec4(plain ? light : presented(light, exposure, tone, white), 1.0);
}
"""
_LAND_VERTEX = (
    _GIVEN
    + """
in vec3 node;
uniform sampler2D heights;
uniform vec3 corner;      // the part's south-west corner at height 0, from the eye [m]
uniform float spacing;
uniform float relief;
uniform float skirt;
uniform bool flat_land;
uniform bool sea;
uniform float sea_level;  // above height 0 [m]
out vec3 away;            // from the eye [m]
out vec2 share;           // of the part, 0..1
out float depth;          // of water [m]
out vec3 air;
uniform float width;
uniform sampler2D air_table;
uniform vec2 towards_sun;
void main() {
    float up = texelFetch(heights, flat_land ? ivec2(0) : ivec2(node.xy), 0).r * relief;
    if (isnan(up) || isinf(up)) up = 0.0;
    depth = sea ? sea_level - up : -1.0;
    float surface = sea ? max(up, sea_level) : up;
    away = corner + vec3(node.xy * spacing, surface - node.z * skirt);
    share = node.xy * spacing / width;
    float aside = dot(away.xy, towards_sun) / max(length(away.xy), 1e-6);
    air = textureLod(air_table, vec2(((0.5 + 0.5 * aside) * (AIRS - 1.0) + 0.5) / AIRS, 0.5), 0.0).rgb;
    gl_Position = clip_from_near * vec4(away, 1.0);
}
"""
)
_LAND_FRAGMENT = (
    _GIVEN
    + """
in vec3 away;
in vec2 share;
in float depth;
in vec3 air;
uniform sampler2D ground;
uniform float width;
uniform float end;
uniform vec3 water;
uniform float clarity;
uniform bool clear;
uniform sampler2D grain;
uniform float grain_times;
out vec4 frame;
void main() {
    vec2 texels = vec2(textureSize(ground, 0));
    vec3 shown = texture(ground, (share * (texels - 1.0) + 0.5) / texels, -0.6).rgb;
    float far = length(away);
    // The grain fits a part a whole number of times, so no border shows.
    vec2 times = share * grain_times;
    shown *= close_ground(texture(grain, times), texture(grain, times * 5.0));
    if (depth > 0.0) {
        vec3 lit = water * (natural ? level_light(daylight) : vec3(1.0));
        shown = under_water(shown, depth, -away / far, lit, clarity, air);
    }
    if (!clear) shown = mix(shown, air, air_share(length(away.xy), end));
    frame = vec4(shown, 1.0);
}
"""
)


def land(ctx: moderngl.Context, library: str) -> moderngl.Program:
    """Return the program that draws a part."""
    return ctx.program(
        vertex_shader=_VERSION + library + _LAND_VERTEX, fragment_shader=_VERSION + library + _LAND_FRAGMENT
    )


def screen(ctx: moderngl.Context, library: str, fragment: str) -> moderngl.Program:
    """Return a program that fills the picture."""
    return ctx.program(vertex_shader=_VERSION + _SCREEN, fragment_shader=_VERSION + library + fragment)
