// flight/scene.glsl -- what is seen from the air: sky, haze, water, and the last curve.
//
//   gives    Backdrop, eased, air_between, backdrop_towards, air_share, under_water, close_ground,
//            presented
//   needs    lighting/daylight_reading.glsl, lighting/daylight_sky.glsl, colour/tone.glsl,
//            colour/encode.glsl
//   units    directions are unit vectors, x east, y north, z up; metres; colours linear
//   source   Fresnel's reflection by Schlick 1994, "An Inexpensive BRDF Model for
//            Physically-based Rendering", with 0.02 for water; light lost exponentially with depth
//   tested   tests/glsl/test_flight_scene.py: the terrain's end is the air's colour, deep water
//            hides the ground; and tests/flight/test_flight.py, in pictures
//
// Where the terrain ends, the air in front of it has taken all of it away, and what is left is the
// backdrop's own colour on the horizon: so no end is seen.
#ifndef FLIGHT_SCENE
#define FLIGHT_SCENE
#include "colour/encode.glsl"
#include "colour/tone.glsl"
#include "lighting/daylight_reading.glsl"
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
    return light / (1.0 + dot(light, vec3(0.2126, 0.7152, 0.0722)) / 4.0);
}

// What air far away adds on the way there.
vec3 air_between(sampler2D daylight, Backdrop sky, vec3 towards) {
    return sky.natural ? eased(air_towards(daylight, towards, sky.height)) : sky.horizon;
}

// The sky, with the sun in it where there is daylight; below the horizon, the air there. A
// pixel is so many radians high.
vec3 backdrop_towards(sampler2D daylight, Backdrop sky, vec3 towards, float pixel) {
    if (!sky.natural) {
        return mix(sky.horizon, sky.zenith, 1.0 - exp(-3.0 * max(towards.z, 0.0)));
    }
    // A little above the horizon is what the air is taken from: there they meet.
    vec3 seen = towards.z < air_rise(sky.height) ? air_towards(daylight, towards, sky.height)
            : sky_towards(daylight, towards, sky.height);
    Sunlight from = sunlight(true, daylight, vec3(0.0), vec2(0.0), vec3(0.0), vec3(0.0));
    float disc = clamp((radians(0.2665) - distance(towards, from.direction)) / pixel + 0.5, 0.0,
                       1.0);
    float lit = dot(from.sun, vec3(0.2126, 0.7152, 0.0722));
    vec3 sun = max(from.sun * min(46750.0, 60.0 / max(lit, 1e-9)), seen);
    return mix(eased(seen), sun, towards.z < horizon_rise(sky.height) ? 0.0 : disc);
}

// How much of what lies so far away the air hides; all of it from `end` on.
float air_share(float far, float end) {
    float t = clamp(far / end, 0.0, 1.0);
    return 1.0 - exp(-1.1 * t * t) * (1.0 - smoothstep(0.72, 0.98, t));
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
