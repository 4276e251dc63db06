// noise/periodic.glsl -- noise that returns to itself: a tile of it fits beside its copy.
//
//   gives    value_noise_periodic, gradient_noise_periodic, gradient_fbm_periodic,
//            cells_periodic
//   needs    noise/fade.glsl, noise/hash.glsl
//   units    places in lattice cells, periods in whole lattice cells; value noise in
//            [0, 1), gradient noise in [-1, 1], distances in cells
//   source   gradient noise after Perlin 1985, "An Image Synthesizer" (SIGGRAPH), with the
//            fade of Perlin 2002, "Improving Noise"; cells after Worley 1996, "A Cellular
//            Texture Basis Function" (SIGGRAPH); wrapped lattices: made here
//   tested   tests/glsl/test_noise.py, against float64 twins with the same hash,
//            and against their own copies one period away
//
// The lattice point is wrapped before it is hashed, the place inside its cell is not: so
// the noise is exactly periodic, and nothing is blended near the tile's edge.
#ifndef NOISE_PERIODIC
#define NOISE_PERIODIC
#include "noise/fade.glsl"
#include "noise/hash.glsl"

// A lattice point in 0..period-1; % alone keeps the sign of a negative point.
ivec2 lattice_wrapped(ivec2 point, ivec2 period) {
    ivec2 rest = point - period * (point / period);
    return rest + period * ivec2(lessThan(rest, ivec2(0)));
}

// A random number at every lattice point, blended between.
float value_noise_periodic(vec2 place, ivec2 period, uint seed) {
    ivec2 low = ivec2(floor(place));
    vec2 share = quintic(place - vec2(low));
    float south = mix(random(lattice_wrapped(low, period), seed),
                      random(lattice_wrapped(low + ivec2(1, 0), period), seed), share.x);
    float north = mix(random(lattice_wrapped(low + ivec2(0, 1), period), seed),
                      random(lattice_wrapped(low + 1, period), seed), share.x);
    return mix(south, north, share.y);
}

// The height at a place of the plane through a lattice point, whose slopes are random in [-1, 1).
float lattice_plane(ivec2 point, vec2 offset, ivec2 period, uint seed) {
    return dot(random_pair(lattice_wrapped(point, period), seed) * 2.0 - 1.0, offset);
}

// A random plane through zero at every lattice point, blended between.
float gradient_noise_periodic(vec2 place, ivec2 period, uint seed) {
    ivec2 low = ivec2(floor(place));
    vec2 offset = place - vec2(low);
    vec2 share = quintic(offset);
    float p00 = lattice_plane(low, offset, period, seed);
    float p10 = lattice_plane(low + ivec2(1, 0), offset - vec2(1.0, 0.0), period, seed);
    float p01 = lattice_plane(low + ivec2(0, 1), offset - vec2(0.0, 1.0), period, seed);
    float p11 = lattice_plane(low + 1, offset - 1.0, period, seed);
    return mix(mix(p00, p10, share.x), mix(p01, p11, share.x), share.y);
}

// Octaves of gradient noise, each twice as fine and `gain` times as strong, over the sum of their
// strengths.
float gradient_fbm_periodic(vec2 place, ivec2 period, int octaves, float gain, uint seed) {
    float total = 0.0;
    float strength = 1.0;
    float strengths = 0.0;
    for (int octave = 0; octave < octaves; octave++) {
        total += strength * gradient_noise_periodic(place, period, seed + uint(octave));
        strengths += strength;
        strength *= gain;
        place *= 2.0;
        period *= 2;
    }
    return total / strengths;
}

// One random point in every cell: distances to the nearest and to the second, and a random number
// of the nearest.
vec3 cells_periodic(vec2 place, ivec2 period, uint seed) {
    ivec2 low = ivec2(floor(place));
    vec3 found = vec3(1e9, 1e9, 0.0);
    // Two cells each way: the second nearest may lie outside the nine around the place.
    for (int y = -2; y <= 2; y++) {
        for (int x = -2; x <= 2; x++) {
            ivec2 cell = low + ivec2(x, y);
            ivec2 key = lattice_wrapped(cell, period);
            float far = length(vec2(cell) + random_pair(key, seed) - place);
            if (far < found.x) {
                found = vec3(far, found.x, random(key, seed + 1u));
            } else {
                found.y = min(found.y, far);
            }
        }
    }
    return found;
}
#endif
