// scene/surface.glsl -- what a pixel shows of the ground, before it is lit.
//
//   gives    Surface, bumps_of
//   needs    lighting/sun.glsl
//   units    colours linear; slopes in metres over metres; shares 0..1
//   source   heights along a normal: Blinn 1978, "Simulation of Wrinkled Surfaces" (SIGGRAPH)
//   tested   tests/glsl/test_near.py
//
// add_cliff, add_water and add_snow of scene/near/ change it, one after another.
#ifndef SCENE_SURFACE
#define SCENE_SURFACE
#include "lighting/sun.glsl"

struct Surface {
    vec3 albedo;     // what a white light would show
    vec3 push;       // the gradient of its bumps' heights along the ground's normal
    float variance;  // of the slopes of its bumps
    float film;      // the share under a film of water
};

// Slopes added to the ground's in x and y, their variance in z, and the film in w. Only what of
// the push lies in the ground's plane turns the normal.
vec4 bumps_of(Surface surface, vec2 slope) {
    vec3 normal = normal_of_slope(slope);
    vec3 turned = normal - (surface.push - dot(surface.push, normal) * normal);
    return vec4(-turned.xy / max(turned.z, 0.2 * normal.z) - slope, surface.variance,
                surface.film);
}
#endif
