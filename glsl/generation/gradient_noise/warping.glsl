// generation/gradient_noise/warping.glsl -- domain warping: noise read at places moved by noise.
//
//   gives    height, and stretch: how many times larger a small square becomes when it is moved,
//            below 0 where it is turned over; for any terrain, not normalised
//   needs    generation/gradient_noise/salt.glsl, noise/octaves.glsl
//   units    heights without unit; stretch: area over area
//   source   Perlin 1985, "An Image Synthesizer" (SIGGRAPH), moved places; Quilez 2002, "Domain
//            warping" (iquilezles.org/articles/warp); the determinant: made here
//   tested   tests/glsl/test_gradient_noise.py, against differences in float64, and against
//            the choice "warped" of generation/gradient_noise/sum
//
//     h(p) = f(p + a g(p)),   g = (g_east, g_north),   stretch = det(I + a dg/dp)
//
// With as many bends as octaves it is what generation/gradient_noise makes with the shape
// "warped", while the last octave's cells are two texels wide or more. The moved place may be
// anywhere, so nothing here can be worked out a column at a time, as plain octaves can.
#include "generation/gradient_noise/salt.glsl"
#include "noise/octaves.glsl"
#pragma kernel(output = "height:r32f, stretch:r32f")

uniform float warp = 0.8;       //! slider(0, 2) step(0.01) How far a place is moved, in cells of
                                //! the first octave
uniform int bends = 2;          //! slider(0, 12) Octaves of the noise that moves places
uniform int octaves = 6;        //! slider(0, 12) Octaves of the noise that is read there
uniform float frequency = 3.0;  //! log_slider(0.25, 64) Cells along the terrain's width in the
                                //! first octave
uniform float gain = 0.4;       //! slider(0, 1) step(0.01) Strength of an octave over the one
                                //! before
uniform uint seed = 7u;         //! slider(0, 9999) Which terrain
uniform bool squares = false;   //! A chessboard instead of noise, to see where places are moved to

// Octaves added up in x, their slopes to the east and to the north in y and z.
vec3 octaves_of(vec2 place, int count, uint which) {
    vec3 total = vec3(0.0);
    float frequency_of = 1.0;
    float strength = 1.0;
    for (int k = 0; k < count; k++) {
        vec3 noise = perlin(place * frequency_of + OCTAVE_SHIFT, lattice_seed(which, k));
        total += strength * vec3(noise.x, noise.yz * frequency_of);
        frequency_of *= 2.0;
        strength *= gain;
    }
    return total;
}

float board(vec2 place) {
    vec2 square = floor(4.0 * place);
    return mod(square.x + square.y, 2.0);
}

// anchor: warp
void kernel(ivec2 texel, out float height, out float stretch) {
    uint which = seed + GRADIENT_NOISE_SALT;
    vec2 place = vec2(texel) * spacing * frequency / extent.x;
    vec3 east = octaves_of(place, bends, which + 0x51ed270bu);
    vec3 north = octaves_of(place, bends, which + 0xa3da4e16u);
    vec2 moved = place + warp * vec2(east.x, north.x);
    height = squares ? board(moved) : octaves_of(moved, octaves, which).x;
    // How the moved place changes for a step to the east, and for one to the north.
    vec2 by_east = vec2(1.0, 0.0) + warp * vec2(east.y, north.y);
    vec2 by_north = vec2(0.0, 1.0) + warp * vec2(east.z, north.z);
    stretch = by_east.x * by_north.y - by_east.y * by_north.x;
}
// end: warp
