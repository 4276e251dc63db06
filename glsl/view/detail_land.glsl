// view/detail_land.glsl -- the land under a coarse cover and a fine image that repeats, seen the more the nearer the eye.
//
//   gives    frame, linear light, over an earlier frame
//   needs    maths/drape.glsl, texturing/detail_near.glsl; a height 0..1, a detail image, and a
//            colour and a light if there are
//   units    metres; colours linear
//   source   Belaiche 2010, section 2.7; the rest as view/land
//   tested   tests/glsl/test_texturing_detail.py, against rays in float64; without strength
//            the same bits as view/land
//
// Both textures are read in one draw, as section 2.4 has it. The cover's colour is the mean
// of what one sees: the detail only moves it up and down.
#include "maths/drape.glsl"
#include "texturing/detail_near.glsl"
#pragma draw(mesh = "grid", output = "frame:rgba16f")

uniform sampler2D height;  //! input("linear")
uniform sampler2D colour;  //! input("linear", "mipmap", "white")
uniform sampler2D light;   //! input("linear", "mipmap", "white")
uniform sampler2D detail;  //! input("linear", "repeat", "mipmap")

uniform int grid = 257;               //! slider(2, 1025) group("Mesh") Vertices a side
uniform float skirt = 0.03;           //! slider(0, 0.5) step(0.005) group("Mesh") How far the cut earth reaches below height 0, over the land's width
uniform vec3 earth = vec3(0.135, 0.10, 0.075);  //! colour group("Mesh") The cut earth's colour
uniform float repeats = 100.0;        //! slider(1, 2000) step(1) group("Detail") How often the detail image stands side by side from west to east
uniform float strength = 1.0;         //! slider(0, 2) step(0.01) group("Detail") How much of it is seen at the eye; 1: as its own greys have it
uniform float reach = 2500.0;         //! log_slider(10, 50000) unit("m") group("Detail") Distance from the eye at which nothing of it is left
uniform float haze = 0.0;             //! slider(0, 2) step(0.01) group("Sky") Air between the eye and the land: how much a land's width of it takes away
uniform vec3 horizon = vec3(0.60, 0.70, 0.80);  //! colour group("Sky") The haze's colour

// As in view/land.
const vec3 NOT_A_NUMBER = vec3(1.0, 0.0, 1.0);
const float SHARPER = -0.7;

bool is_number(float value) {
    return !isnan(value) && !isinf(value);
}

vec4 vertex(vec3 corner, out vec3 position, out float mark) {
    float share = textureLod(height, drape_uv(corner.xy, textureSize(height, 0)), 0.0).r;
    bool broken = !is_number(share);
    float up = broken ? 0.0 : share * relief;
    float foot = min(-skirt * max(extent.x, extent.y), up);
    position = vec3(corner.xy * extent, mix(up, foot, corner.z));
    mark = broken ? -1000.0 : corner.z;
    return clip_from_world * vec4(position, 1.0);
}

vec3 cut(vec2 share, float below) {
    vec2 inside = min(share, 1.0 - share);
    return earth * (inside.x < inside.y ? 0.7 : 1.0) * mix(1.0, 0.55, below);
}

vec4 fragment(vec3 position, float mark) {
    vec2 share = position.xy / extent;
    vec3 shown = texture(colour, drape_uv(share, textureSize(colour, 0)), SHARPER).rgb;
    // Tiles are square on the ground. The level after the last is the last: the image's mean.
    vec3 fine = texture(detail, share * repeats * vec2(1.0, extent.y / extent.x), SHARPER).rgb;
    vec3 mean = textureLod(detail, vec2(0.5), 99.0).rgb;
    float far = distance(eye, position);
    shown = with_detail(shown, fine, mean, strength * detail_nearness(far, reach));
    shown *= texture(light, drape_uv(share, textureSize(light, 0)), SHARPER).rgb;
    if (mark > 0.0) shown = cut(share, min(mark, 1.0));
    if (mark < -10.0 || !is_number(shown.r + shown.g + shown.b)) shown = NOT_A_NUMBER;
    if (haze > 0.0) shown = mix(horizon, shown, exp(-haze * far / max(extent.x, extent.y)));
    return vec4(shown, 1.0);
}
