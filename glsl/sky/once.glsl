// sky/once.glsl -- the sky of light that air has scattered once.
//
//   gives    sky: half of the horizon from left to right, the sun's side in the middle, from the
//            horizon up to the zenith; ratio: of its blue to its red; molecules: the
//            same of what they scatter
//   needs    sky/air.glsl, sky/shell.glsl
//   units    the sky 0..1 of white, as on film; its light: 1 of a white sheet that faces the sun
//            outside the air
//   source   Nishita, Sirai, Tadamura and Nakamae 1993, "Display of the Earth Taking into Account
//            Atmospheric Scattering"
//   tested   tests/glsl/test_lesson_outdoors.py, against integrals in float64
//
// The two integrals themselves. lighting/daylight adds what is scattered again, and reads the
// inner one from a table (sky/columns.glsl).
#include "sky/air.glsl"
#include "sky/shell.glsl"
#pragma kernel(output = "sky:rgba16f, ratio:r32f, molecules:r32f")

uniform float elevation = 35.0;  //! slider(0, 90) step(0.5) unit("°") Of the sun over the horizon
uniform float turbidity = 1.5;   //! slider(1, 10) step(0.1) Haze: 1 none, 2 very clear, 6 hazy
uniform float exposure = 5.0;    //! log_slider(1, 100)
                                 //! Light of 1 / exposure is shown as 63 % of white

const float EYE = 0.001;      // [km] over the sea
const int STEPS = 24;         // along the line of sight
const int SUN_STEPS = 12;     // from there to the sun
const float DISC = 1000.0;    // its light: less than it has, and still white by day
const float PI = 3.14159265;

// The middle of a step and its length, shares of the way: short at first, where air is dense.
vec2 step_of(int i, int steps) {
    float share = (float(i) + 0.5) / float(steps);
    return vec2(share * share, 2.0 * share / float(steps));
}

// anchor: depth
vec3 optical_depth(Air air, float height, float rise) {
    float far = distance_to_top(height, rise);
    vec3 depth = vec3(0.0);
    for (int i = 0; i < SUN_STEPS; i++) {
        vec2 along = far * step_of(i, SUN_STEPS);   // to its middle, and its length
        depth += extinction(air, densities(height_along(height, rise, along.x))) * along.y;
    }
    return depth;
}
// end: depth

vec3 light_from(Air air, float rise, float sun_rise, float together) {
    float far = distance_to_top(EYE, rise);
    vec3 light = vec3(0.0);
    // anchor: once
    vec3 left = vec3(1.0);                          // of the light from here to the eye
    for (int i = 0; i < STEPS; i++) {
        vec2 along = far * step_of(i, STEPS);
        float height = height_along(EYE, rise, along.x);
        vec3 amounts = densities(height);
        float sun_there = ((EARTH_RADIUS + EYE) * sun_rise + along.x * together)
                        / (EARTH_RADIUS + height);
        vec3 sunlight = exp(-optical_depth(air, height, sun_there));
        vec3 scattered = air.molecules * amounts.x * phase_molecules(together)
                       + AEROSOL_ALBEDO * air.aerosol * amounts.y * phase_aerosol(together);
        vec3 taken = exp(-extinction(air, amounts) * along.y);
        light += left * sqrt(taken) * sunlight * scattered * along.y;
        left *= taken;
    }
    // end: once
    return PI * light;
}

void kernel(ivec2 texel, out vec4 sky, out float ratio, out float molecules) {
    vec2 turned = (vec2(texel) + 0.5) / vec2(size);
    float up = 0.5 * PI * turned.y;
    float aside = PI * (turned.x - 0.5);
    float sun_up = radians(elevation);
    float together = sin(up) * sin(sun_up) + cos(up) * cos(sun_up) * cos(aside);
    Air air = air_of(turbidity);
    molecules = air.molecules.b / air.molecules.r;
    vec3 light = light_from(air, sin(up), sin(sun_up), together);
    ratio = light.b / max(light.r, 1e-6);
    // The sun's disc, four times as wide as it is, in the colour of what is left of its light.
    if (together > cos(4.0 * radians(SUN_RADIUS))) {
        light += DISC * exp(-optical_depth(air, EYE, sin(sun_up)));
    }
    sky = vec4(1.0 - exp(-exposure * light), 1.0);  // as on film
}
