// lighting/daylight/dome.glsl -- the light of a cloudless sky, by a sum along each line of sight.
//
//   gives    dome: in its left half what molecules scatter and what was scattered more than
//            once, in its right half what aerosol scatters, without its phase; one such table
//            over the other for each of several heights of the eye
//   needs    sky/bounced.glsl, sky/dome.glsl, sky/slab.glsl, lighting/sun.glsl; the sun's place,
//            the air and two tables
//   units    per unit of the sun's light outside the air, times pi: a sky of 1 all round lights
//            level ground by 1
//   source   Nishita et al. 1993 and Hillaire 2020, as in sky/slab.glsl and
//            lighting/daylight/bounced; the night's light: 6.5e-4 lux, as when the sun is 18
//            degrees down (Seidelmann 1992, "Explanatory Supplement to the Astronomical Almanac",
//            chapter 9), over the sun's 127,500
//   tested   tests/glsl/test_air.py, against float64; tests/glsl/test_daylight.py, against the
//            almanac's daylight
//
// The analytic sky of Preetham, Shirley and Smits 1999 is not defined after sunset, and as the sun
// sets it is 14 times as bright as measured. This sum follows measured daylight from noon to the
// end of twilight, and its table is small enough for a sun that moves.
#include "lighting/sun.glsl"
#include "sky/bounced.glsl"
#include "sky/dome.glsl"
#include "sky/slab.glsl"
#pragma kernel(output = "dome:rgba32f")

uniform sampler2D place;         //! input
uniform sampler2D columns;       //! input
uniform sampler2D bounced;       //! input
uniform sampler2D air;           //! input

const int STEPS = 32;
const float NIGHT = 5.1e-9;

vec4 kernel(ivec2 texel) {
    int half_width = max(size.x / 2, 1);
    bool right = texel.x >= half_width;
    int rows = max(size.y / DOMES, 1);
    int table = min(texel.y / rows, DOMES - 1);
    float height = dome_height(table);
    vec2 share = vec2(right ? texel.x - half_width : texel.x, texel.y - table * rows)
            / vec2(max(ivec2(half_width, rows) - 1, 1));
    vec2 way = dome_start(min(share, 1.0), height);
    vec3 sun = to_sun(texelFetch(place, ivec2(0), 0).rg);
    float together = way.x * sun.z + sqrt((1.0 - way.x * way.x) * dot(sun.xy, sun.xy)) * way.y;
    Air scatters = air_of(texelFetch(air, ivec2(0), 0).r);
    float whole = distance_to_top(height, way.x);
    vec3 left = vec3(1.0);
    vec3 molecules = vec3(0.0);
    vec3 aerosol = vec3(0.0);
    vec3 often = vec3(0.0);
    for (int k = 0; k < STEPS; k++) {
        float before = float(k) / float(STEPS);
        float after = float(k + 1) / float(STEPS);
        Slab here = slab(columns, scatters, height, way.x, sun.z, together,
                         whole * before * before, whole * after * after);
        molecules += left * here.molecules;
        aerosol += left * here.aerosol;
        often += left * here.share * bounced_at(bounced, here.height, here.sun_rise);
        left *= here.left;
    }
    vec3 found = right ? aerosol : molecules * phase_molecules(together) + often;
    // Numbers near the smallest there are come out differently on different processors.
    found *= vec3(greaterThan(found, vec3(1e-25)));
    return vec4(3.14159265 * found + (right ? 0.0 : NIGHT), 1.0);
}
