// scene/near/wet.glsl -- what water in the ground does to its colour, and the film on top of it.
//
//   gives    wet_albedo, film_of, add_water
//   needs    scene/near/bumps.glsl, scene/surface.glsl, water/fresnel.glsl
//   units    colours linear; shares 0..1
//   source   light that is caught in a film of water: Angstrom 1925, "The albedo of various
//            surfaces of ground" (Geografiska Annaler 7), as Lekner and Dorf 1988, "Why some
//            things are darker when wet" (Applied Optics 27), eqs. 1 to 5, correct it
//   tested   tests/glsl/test_near.py, against Fresnel's equations integrated in float64
#ifndef SCENE_NEAR_WET
#define SCENE_NEAR_WET
#include "scene/near/bumps.glsl"
#include "scene/surface.glsl"
#include "water/fresnel.glsl"

const float HELD_BACK = 0.4746;  // of light from all sides in water, what its surface throws back

// Of a matt surface under a film. What comes back from it is thrown back in part, again and again.
vec3 wet_albedo(vec3 dry) {
    return (1.0 - DIFFUSE_MIRRORED) * (1.0 - HELD_BACK) * dry / (1.0 - HELD_BACK * dry);
}

// How much of a pixel stands under water: hollows first, and none on a slope, where it runs off.
// `over` is the height over the mean, `hidden` the rms of what is too small to be seen, in metres.
float film_of(float wetness, float over, float hidden, float slope) {
    float level = 0.16 * (wetness - 0.75);
    float soft = 0.01 + 2.0 * hidden;
    float stands = smoothstep(0.45, 0.7, wetness) * (1.0 - smoothstep(0.03, 0.2, slope));
    return stands * smoothstep(-soft, soft, level - over);
}

// Ground that is so wet is darker, and where water stands it is smooth.
void add_water(inout Surface surface, float wetness, Bumps bumps, float slope) {
    if (wetness <= 0.0) return;
    surface.albedo = mix(surface.albedo, wet_albedo(surface.albedo),
                         smoothstep(0.1, 0.6, wetness));
    surface.film = film_of(wetness, bumps.height, bumps.hidden, slope);
    surface.push *= 1.0 - surface.film;
    surface.variance *= (1.0 - surface.film) * (1.0 - surface.film);
}
#endif
