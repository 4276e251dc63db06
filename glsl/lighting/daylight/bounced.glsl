// lighting/daylight/bounced.glsl -- light that air and ground have scattered twice or more.
//
//   gives    bounced: the logarithm of it, by the sun's height along x and by height along y; in
//            alpha what the ground throws back
//   needs    sky/bounced.glsl, sky/slab.glsl; the columns, the air
//   units    per unit of the sun's light outside the air, per steradian
//   source   Hillaire 2020, "A Scalable and Production Ready Sky and Atmosphere Rendering
//            Technique", eqs 5 to 10
//   tested   tests/glsl/test_air.py, against a finer sum in float64
//
// It is taken as if it came from all around.
//
// Light scattered twice is summed over all directions. Each further time keeps the same part f
// of it, so that all times together are 1 + f + f² + … = 1 / (1 - f) of the second.
#include "sky/bounced.glsl"
#include "sky/slab.glsl"
#pragma kernel(output = "bounced:rgba32f")

uniform sampler2D columns;         //! input
uniform sampler2D air;             //! input
uniform float ground = 0.2;        //! slider(0, 1) step(0.01)
                                   //! How much of its light the ground throws back to the sky

const int RISES = 12;
const int SIDES = 6;
const int STEPS = 16;

vec4 kernel(ivec2 texel) {
    vec2 start = bounced_start(vec2(texel) / vec2(max(size - 1, 1)));
    Air scatters = air_of(texelFetch(air, ivec2(0), 0).r);
    vec3 second = vec3(0.0);
    vec3 again = vec3(0.0);
    float sun_level = sqrt(max(1.0 - start.x * start.x, 0.0));
    for (int ray = 0; ray < RISES * SIDES; ray++) {
        int row = ray / SIDES;
        // Closest around the level paths, which are all that light comes by in twilight.
        float step_of = (float(row) + 0.5) / float(RISES) * 2.0 - 1.0;
        float rise = step_of * abs(step_of);
        float weight = 2.0 * abs(step_of);
        // The two halves on both sides of the sun are alike.
        float side = (float(ray - row * SIDES) + 0.5) / float(SIDES) * 3.14159265;
        float together = rise * start.x + sqrt(1.0 - rise * rise) * sun_level * cos(side);
        float to_ground = distance_to_ground(start.y, rise);
        float whole = to_ground >= 0.0 ? to_ground : distance_to_top(start.y, rise);
        vec3 left = vec3(weight);
        for (int k = 0; k < STEPS; k++) {
            float before = float(k) / float(STEPS);
            float after = float(k + 1) / float(STEPS);
            Slab here = slab(columns, scatters, start.y, rise, start.x, together,
                             whole * before * before, whole * after * after);
            second += left * (here.molecules + here.aerosol) * 0.0795775;  // 1 / 4 pi
            again += left * here.share;
            left *= here.left;
        }
        if (to_ground >= 0.0) {
            float sun_rise = ((EARTH_RADIUS + start.y) * start.x + whole * together)
                    / EARTH_RADIUS;
            // 1 / pi
            second += left * left_of_sunlight(columns, scatters, 0.0, sun_rise)
                    * (max(sun_rise, 0.0) * ground * 0.3183099);
        }
    }
    float count = float(RISES * SIDES);
    vec3 light = second / count / (1.0 - min(again / count, 0.95));
    return vec4(log(light + LEAST_BOUNCED), ground);
}
