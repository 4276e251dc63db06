// water/foam.glsl -- how much of a water surface is foam: at shores, on crests and in rapids.
//
//   gives    FOAM_ALBEDO, shore_cover, wash_cover, whitecap_cover, foam_of
//   needs    noise/gradient.glsl: pure functions, no uniforms, no textures
//   units    metres, seconds; metres a second; shares 0..1
//   source   waves break where the water is 1 / 0.78 as deep as they are high: McCowan 1894; cover
//            by whitecaps 3.84e-6 U^3.41: Monahan and O'Muircheartaigh 1980, "Optimal Power-law
//            Description of Oceanic Whitecap Coverage", J. Phys. Oceanogr. 10; albedo: Koepke
//            1984, "Effective reflectance of oceanic whitecaps", Applied Optics 23(11), of fresh
//            foam; its pattern made here
//   tested   tests/glsl/test_water_surface.py: the mean of the pattern is the cover; pixels of any
//            width have as much of the wash
//
// A cover is a mean. The pattern has it where it can be seen, and goes over to it where its
// patches are narrower than two pixels.
#ifndef WATER_FOAM
#define WATER_FOAM
#include "noise/gradient.glsl"

const vec3 FOAM_ALBEDO = vec3(0.55);
const float BREAKER = 1.282;  // depth over height
const uint FOAM_SALT = 0x5acbe886u;  // CRC-32 of "water/foam"

// Over `depth`, by waves so high that come in every few seconds: bands that run up the shore.
float shore_cover(float depth, float high, float seconds, float uneven) {
    float breaks = BREAKER * high;
    if (depth >= breaks || high < 0.01) return 0.0;
    float near = 1.0 - depth / breaks;
    float period = 5.0 * sqrt(max(high, 0.04));
    float run = fract(2.5 * depth / breaks + seconds / period + uneven);
    return near * mix(0.12, 0.85, run * run) * min(high / 0.15, 1.0);
}

// The part of a pixel of a width that is under the wash of a shore so far from its middle: most at
// the shore, none from `wide` on, where waves meet a wall as well as where they run out.
float wash_cover(float shore_distance, float wide, float pixel) {
    vec2 span = clamp(vec2(shore_distance - 0.5 * pixel, shore_distance + 0.5 * pixel), 0.0, wide);
    vec2 within = span * (1.0 - 0.5 * span / max(wide, 1e-6));
    return clamp((within.y - within.x) / max(pixel, 1e-6), 0.0, 1.0);
}

float whitecap_cover(float wind) {
    return min(3.84e-6 * pow(max(wind, 0.0), 3.41), 0.3);
}

// Of a mean cover, what is foam at a place: where noise is high. `pixel` is how wide one is there.
float foam_of(float cover, vec2 place, float lump, float pixel) {
    if (cover <= 1e-4) return 0.0;
    // Only the tips of lumps are left of sparse foam: as specks of a pixel they would flicker.
    float patch_wide = lump * min(2.0 * sqrt(cover), 1.0);
    float shown = clamp(0.5 * patch_wide / pixel - 1.0, 0.0, 1.0);
    float high = perlin(place / lump, FOAM_SALT).x + 0.5 * perlin(place / (0.37 * lump),
            FOAM_SALT + 1u).x;
    // Fitted to the quantiles of that noise, through the smoothstep.
    float over = 0.9945 * atan(log(cover / max(1.0 - cover, 1e-3)) / 4.198);
    float pattern = smoothstep(-0.10, 0.10, high + over);
    return mix(min(cover, 1.0), pattern, shown);
}
#endif
