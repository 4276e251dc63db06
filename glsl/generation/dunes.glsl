// generation/dunes.glsl -- dunes on a terrain's low ground: long backs to the wind, steep lees.
//
//   gives    height; sand: 0 where none lies, towards 1 where it is deep
//   needs    noise/periodic.glsl, terrain/heightfield.glsl; a height
//   units    metres inside, heights without unit outside
//   source   the shape of transverse dunes: Bagnold 1941, "The Physics of Blown Sand and Desert
//            Dunes", chapter 13 (lee sides at the angle of repose); the formula: made here
//   tested   tests/glsl/test_dunes.py: the lee's slope, where sand lies
//
// One wave whose phase runs with the wind, bent by noise so that crests wander and end. It rises
// slowly and falls over the rest of its length, which is as long as the angle of repose asks for,
// half of it at most: taller dunes than can stand so close are lowered to that. Small ones, a
// fourth as long, ride on the backs of large ones. Where crests are straight, the slopes of both
// together are no steeper than sand can be; where noise draws crests together they may be.
#include "noise/periodic.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "height:r32f, sand:r16f")

uniform sampler2D height;  //! input("zero")

uniform float between = 500.0;   //! log_slider(10, 10000) unit("m") From crest to crest
uniform float tallest = 45.0;    //! log_slider(0.1, 500) unit("m")
                                 //! Of the highest dune, and at most 0.325 of the way from crest
                                 //! to crest: steeper sand slides
uniform float wind = 250.0;      //! angle(0, 360) Where the wind comes from
uniform float bends = 0.9;       //! slider(0, 3) step(0.05)
                                 //! How far crests wander, in lengths from crest to crest
uniform vec2 below = vec2(120.0, 320.0);  //! slider(-500, 9000) unit("m") parts("all", "none")
                                 //! Heights above sea level between which sand thins out
uniform float steep = 0.2;       //! slider(0.01, 2) step(0.01) Slopes on which none lies
uniform uint seed = 1u;          //! slider(0, 9999) Which dunes

const uint SALT = 0xdc4dd884u;  // CRC-32 of "generation/dunes"
const float REPOSE = 0.65;  // the slope of dry sand that slides: 33 degrees
const ivec2 ENDLESS = ivec2(1 << 20);

float noise_at(vec2 place, float wide, uint which) {
    return gradient_fbm_periodic(place / wide, ENDLESS, 2, 0.5, seed + SALT + which);
}

// A wave that rises slowly and falls over the share `lee`: 0..1, flat at its foot.
float dune(float phase, float lee) {
    float t = fract(phase);
    float rise = t / (1.0 - lee);
    return t < 1.0 - lee ? rise * rise * (3.0 - 2.0 * rise) : (1.0 - t) / lee;
}

// Dunes so long from crest to crest, in shares of the tallest.
float field_at(vec2 place, float wave, float tall, uint which) {
    vec2 to = vec2(-sin(radians(wind)), -cos(radians(wind)));
    float bend = noise_at(place, 2.2 * wave, which);
    bend += 0.4 * noise_at(place, 0.9 * wave, which + 1u);
    float lee = clamp(tall / (REPOSE * wave), 0.05, 0.5);
    float stands = smoothstep(-0.6, 0.5, noise_at(place, 2.8 * wave, which + 2u));
    return (0.15 + 0.85 * stands) * dune(dot(place, to) / wave + bends * bend, lee);
}

// The height given where a texel is, and how much sand lies there.
vec2 bare_at(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 from = place_on(grid, texel, size);
    float before = height_at(height, from);
    vec2 rise = slope_at(height, from, spacing_of(grid, extent), CENTRAL_DIFFERENCES);
    float metres = before * relief + base_elevation;
    float lies = 1.0 - smoothstep(below.x, max(below.y, below.x + 1e-3), metres);
    return vec2(before, lies * (1.0 - smoothstep(0.5 * steep, steep, relief * length(rise))));
}

void kernel(ivec2 texel, out float height, out float sand) {
    vec2 bare = bare_at(texel);
    vec2 place = share_of_texel(texel, size) * extent;
    float highest = min(tallest, 0.5 * REPOSE * between);
    float large = field_at(place, between, highest, 1u);
    float small = field_at(place, 0.25 * between, 0.2 * highest, 4u) * (1.0 - large);
    sand = bare.y;
    height = bare.x + sand * highest * (0.75 * large + 0.04 * small) / max(relief, 1e-3);
}
