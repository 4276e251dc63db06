// noise/octaves.glsl -- octaves of gradient noise added up: plain, ridged, billowing or warped.
//
//   gives    Octaves, octave, octave_weight, cells_a_metre, octaves_sum, and the names of the
//            choices
//   needs    noise/gradient.glsl, noise/simplex.glsl, noise/lattice.glsl
//   units    places in cells of the first octave; noise in x, its slopes in noise per such
//            cell in y and z. The first octave lies in [-1, 1] (ridged: 0..1), each next one
//            adds at most `gain` times as much
//   source   ridges: Musgrave, in Ebert and others 2003, "Texturing and Modeling", chapter 16
//            (RidgedMultifractal, offset 1 and gain 2); billows: Perlin 1985 (turbulence);
//            slopes by the chain rule, derived here
//   tested   tests/glsl/test_gradient_noise.py, against float64 twins and finite differences
//
// Every octave is moved east by the same uneven part of its own cell. Otherwise all lattice
// points would meet at those of the first octave, where every octave is zero.
//
// A cell must be wider than a texel to be seen: an octave fades between two texels a cell and
// one, and finer ones are left out. So at a larger size the same terrain gains detail, and at a
// smaller one it does not turn to noise.
#ifndef NOISE_OCTAVES
#define NOISE_OCTAVES
#include "noise/gradient.glsl"
#include "noise/simplex.glsl"

const int PERLIN = 0;
const int SIMPLEX = 1;

// In cells, east and north. Lattice rows may meet, points may not; that rows do is what
// noise/columns.glsl gains by.
const vec2 OCTAVE_SHIFT = vec2(0.618034, 0.0);

// The choices of how octaves are added.
const int PLAIN = 0;
const int RIDGED = 1;
const int BILLOW = 2;
const int WARPED = 3;

struct Octaves {
    int basis;         // PERLIN or SIMPLEX
    int count;         // 0 gives flat terrain at 0
    float lacunarity;  // cells of an octave to one of the octave before, above 1
    float gain;        // strength of an octave over the one before
    float texels;      // texels to a cell of the first octave, 2 or more
    uint seed;
};

// Cells to a metre in the first octave: `frequency` along the width, but none below
// two texels.
float cells_a_metre(float frequency, vec2 extent, vec2 spacing) {
    return min(frequency / extent.x, 0.5 / max(spacing.x, spacing.y));
}

// How strong an octave is whose cells are so many texels wide.
float octave_weight(float texels) {
    return clamp(texels - 1.0, 0.0, 1.0);
}

// One octave; `frequency` is its cells to one of the first octave.
vec3 octave(vec2 place, Octaves o, int which, float frequency) {
    vec2 there = place * frequency + OCTAVE_SHIFT;
    uint seed = lattice_seed(o.seed, which);
    // anchor: chain
    vec3 noise = o.basis == PERLIN ? perlin(there, seed) : simplex(there, seed);
    return vec3(noise.x, noise.yz * frequency);
    // end: chain
}

// Billows: creases along the zeros of each octave, pointing down. Soft hills, sharp valleys.
vec3 billow(vec3 noise) {
    return (noise.x < 0.0 ? -2.0 : 2.0) * noise - vec3(1.0, 0.0, 0.0);
}

// Ridges: creases pointing up, and squared. What an octave adds is weighed by twice what the
// octave before it gave there, so ridges are rough and valleys stay smooth.
vec3 ridge(vec3 noise, vec3 before) {
    vec3 weight = before.x < 0.5 ? 2.0 * before : vec3(1.0, 0.0, 0.0);
    float crest = 1.0 - abs(noise.x);
    vec2 fall = (noise.x < 0.0 ? 2.0 : -2.0) * crest * noise.yz;
    return vec3(weight.x * crest * crest, weight.yz * crest * crest + weight.x * fall);
}

// The sum of octaves, plain, ridged or billowing.
vec3 octaves_added(int shape, vec2 place, Octaves o) {
    vec3 total = vec3(0.0);
    vec3 before = vec3(1.0, 0.0, 0.0);
    float frequency = 1.0;
    float strength = 1.0;
    // anchor: sum
    for (int k = 0; k < o.count && frequency < o.texels; k++) {
        vec3 noise = octave(place, o, k, frequency);
        if (shape == BILLOW) noise = billow(noise);
        if (shape == RIDGED) noise = before = ridge(noise, before);
        total += strength * octave_weight(o.texels / frequency) * noise;
        frequency *= o.lacunarity;
        strength *= o.gain;
    }
    // end: sum
    return total;
}

// The plain sum at a place that two more sums have moved, by up to about `warp` cells each way.
vec3 octaves_warped(vec2 place, Octaves o, float warp) {
    Octaves other = o;
    // Seeds that no slider reaches.
    other.seed = o.seed + 0x51ed270bu;
    vec3 east = octaves_added(PLAIN, place, other);
    other.seed = o.seed + 0xa3da4e16u;
    vec3 north = octaves_added(PLAIN, place, other);
    vec3 moved = octaves_added(PLAIN, place + warp * vec2(east.x, north.x), o);
    return vec3(moved.x, moved.yz + warp * (moved.y * east.yz + moved.z * north.yz));
}

vec3 octaves_sum(int shape, vec2 place, Octaves o, float warp) {
    return shape == WARPED ? octaves_warped(place, o, warp) : octaves_added(shape, place, o);
}
#endif
