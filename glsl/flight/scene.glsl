// flight/scene.glsl -- what is seen from the air: haze, water, the terrain's end, the last curve.
//
//   gives    Backdrop, eased, air_between, backdrop_towards, end_share, air_share, under_water,
//            close_ground, presented
//   needs    lighting/daylight_sky.glsl, colour/luminance.glsl, colour/tone.glsl,
//            colour/encode.glsl
//   units    directions are unit vectors, x east, y north, z up; metres; colours linear
//   source   Fresnel's reflection by Schlick 1994, "An Inexpensive BRDF Model for
//            Physically-based Rendering", with 0.02 for water; light lost exponentially with depth
//   tested   tests/glsl/test_flight_scene.py: the terrain's end is the air's colour, deep water
//            hides the ground; and tests/flight/test_flight.py, in pictures
//
// Where the terrain ends, the air in front of it has taken all of it away, and what is left is the
// backdrop's own colour there: so no end is seen. Under the sky of a daylight the air is that of
// scene/air, and the terrain ends in the picture of the sky.
#ifndef FLIGHT_SCENE
#define FLIGHT_SCENE
#include "colour/encode.glsl"
#include "colour/luminance.glsl"
#include "colour/tone.glsl"
#include "lighting/daylight_sky.glsl"

struct Backdrop {
    bool natural;   // the sky of lighting/daylight, which then there must be, or the two colours
    vec3 zenith;
    vec3 horizon;
    float height;   // of the eye over the sea  [km]
};

// Around the sun the sky is ten times as bright as elsewhere, and would wash out all terrain below
// it. An eye gets used to it, a picture does not: the brightest parts are brought down to 4.
vec3 eased(vec3 light) {
    return light / (1.0 + luminance(light) / 4.0);
}

// What air far away adds on the way there, and level water mirrors.
vec3 air_between(sampler2D daylight, Backdrop sky, vec3 towards) {
    return sky.natural ? eased(air_towards(daylight, towards, sky.height)) : sky.horizon;
}

// The sky of two colours; below the horizon, the air there.
vec3 backdrop_towards(Backdrop sky, vec3 towards) {
    return mix(sky.horizon, sky.zenith, 1.0 - exp(-3.0 * max(towards.z, 0.0)));
}

// How much the backdrop takes the place of what lies so far away: of all from `end` on.
float end_share(float far, float end) { return smoothstep(0.72, 0.98, far / end); }

// How much of what lies so far away air of one colour hides.
float air_share(float far, float end) {
    float t = clamp(far / end, 0.0, 1.0);
    return 1.0 - exp(-1.1 * t * t) * (1.0 - end_share(far, end));
}

// The ground through so many metres of water, and what the water mirrors; above water, the ground.
vec3 under_water(vec3 ground, float depth, vec3 towards_eye, vec3 water, float clarity,
                 vec3 mirrored) {
    float hidden = 1.0 - 0.6 * exp(-depth / clarity);
    float share = 0.02 + 0.98 * pow(1.0 - clamp(towards_eye.z, 0.0, 1.0), 5.0);
    return mix(mix(ground, water, hidden), mirrored, share);
}

// What the ground's texture has no texels for, as a factor around 1: grain near by. `grain` is
// noise around a half, whose mipmaps are a half: far away nothing is left of it, and nothing
// flickers.
float close_ground(vec4 coarse, vec4 fine) {
    return 1.0 + 0.5 * (coarse.r - 0.5) + 0.6 * (fine.g - 0.5);
}

vec3 presented(vec3 light, float exposure, int tone, float white) {
    light = max(light, 0.0) * exp2(exposure);
    if (tone == 1) light = tone_reinhard(light, white);
    if (tone == 2) light = tone_film(light);
    return srgb_from_linear(light);
}
#endif
