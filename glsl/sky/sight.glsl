// sky/sight.glsl -- the light of a cloudless sky along one line of sight.
//
//   gives    Sight, sight
//   needs    sky/bounced.glsl, sky/slab.glsl; the tables of lighting/daylight/columns and
//            lighting/daylight/bounced
//   units    kilometres; per unit of the sun's light outside the air, times pi: a sky of 1 all
//            round lights level ground by 1
//   source   Nishita et al. 1993 and Hillaire 2020, as in sky/slab.glsl and
//            lighting/daylight/bounced; the night's light: 6.5e-4 lux, as when the sun is 18
//            degrees down (Seidelmann 1992, "Explanatory Supplement to the Astronomical Almanac",
//            chapter 9), over the sun's 127,500
//   tested   tests/glsl/test_air.py, against float64; tests/glsl/test_daylight.py, against the
//            almanac's daylight
#ifndef SKY_SIGHT
#define SKY_SIGHT
#include "sky/bounced.glsl"
#include "sky/slab.glsl"

struct Sight {
    vec3 molecules;  // what they scatter, all that was scattered more than once, and the night's
    vec3 aerosol;    // what it scatters, without its phase
};

const int SIGHT_STEPS = 32;
const float NIGHT = 5.1e-9;

// Numbers near the smallest there are come out differently on different processors.
vec3 without_tiny(vec3 found) {
    return found * vec3(greaterThan(found, vec3(1e-25)));
}

// `direction` from a height: the sine of its elevation, and the cosine of its azimuth from the
// sun's.
Sight sight(sampler2D columns, sampler2D bounced, Air scatters, float height, vec2 direction,
            vec3 sun) {
    float level = sqrt((1.0 - direction.x * direction.x) * dot(sun.xy, sun.xy));
    float together = direction.x * sun.z + level * direction.y;
    float whole = distance_to_top(height, direction.x);
    vec3 left = vec3(1.0);
    vec3 molecules = vec3(0.0);
    vec3 aerosol = vec3(0.0);
    vec3 often = vec3(0.0);
    for (int k = 0; k < SIGHT_STEPS; k++) {
        float before = float(k) / float(SIGHT_STEPS);
        float after = float(k + 1) / float(SIGHT_STEPS);
        Slab here = slab(columns, scatters, height, direction.x, sun.z, together,
                         whole * before * before, whole * after * after);
        molecules += left * here.molecules;
        aerosol += left * here.aerosol;
        often += left * here.share * bounced_at(bounced, here.height, here.sun_rise);
        left *= here.left;
    }
    vec3 found = molecules * phase_molecules(together) + often;
    return Sight(3.14159265 * without_tiny(found) + NIGHT, 3.14159265 * without_tiny(aerosol));
}
#endif
