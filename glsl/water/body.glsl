// water/body.glsl -- light in the water: how much of it is left, and what the water sends back.
//
//   gives    attenuation_of, light_left, light_down, path_in_water
//   needs    water/fresnel.glsl: pure functions, no uniforms, no textures
//   units    metres; per metre; light without unit, 1 for white
//   source   absorption of pure water at 620, 550 and 450 nm: Pope and Fry 1997, "Absorption
//            spectrum (380-700 nm) of pure water", Applied Optics 36(33), table 3; of what is
//            dissolved, which takes blue: Bricaud, Morel and Prieur 1981, Limnol. Oceanogr. 26(1);
//            the law of Beer and Lambert
//   tested   tests/glsl/test_water_surface.py, against the integral along both paths in float64
//
// Light goes down from the sun and up to the eye, each path bent at the surface, and on both of
// them red goes first. What matter in the water sends back grows as the light of the bed is lost.
#ifndef WATER_BODY
#define WATER_BODY
#include "water/fresnel.glsl"

const vec3 PURE = vec3(0.2755, 0.0565, 0.00922);    // [1/m]
const vec3 DISSOLVED = vec3(0.95, 1.0, 1.35);       // what other matter takes, of green 1

// Of water in which 1 / e of the green light is left after `clarity` metres.
vec3 attenuation_of(float clarity) {
    return PURE + DISSOLVED * max(1.0 / clarity - PURE.g, 0.0);
}

// Both ways through so much depth, by the cosines in the air to the sun and to the eye.
float path_in_water(float depth, float to_sun, float to_eye) {
    return depth * (1.0 / refracted_cosine(clamp(to_sun, 0.0, 1.0))
                    + 1.0 / refracted_cosine(clamp(to_eye, 0.0, 1.0)));
}

vec3 light_left(vec3 attenuation, float path) {
    return exp(-min(attenuation * path, 80.0));
}

// Of sun and sky on level water, what goes on into it.
vec3 light_down(vec3 sun_on_level, vec3 sky, float to_sun) {
    return sun_on_level * (1.0 - fresnel_of_water(to_sun)) + sky * (1.0 - DIFFUSE_MIRRORED);
}
#endif
