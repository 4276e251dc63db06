// lighting/daylight/dome.glsl -- the light of a cloudless sky, by a sum along each line of sight.
//
//   gives    dome: in its left half what molecules scatter and what was scattered more than
//            once, in its right half what aerosol scatters, without its phase; one such table
//            over the other for each of several heights of the eye
//   needs    sky/dome.glsl, sky/sight.glsl, lighting/sun.glsl; the sun's place, the air and two
//            tables
//   units    per unit of the sun's light outside the air, times pi: a sky of 1 all round lights
//            level ground by 1
//   source   see sky/sight.glsl
//   tested   tests/glsl/test_air.py, against float64; tests/glsl/test_daylight.py, against the
//            almanac's daylight
//
// The analytic sky of Preetham, Shirley and Smits 1999 is not defined after sunset, and as the sun
// sets it is 14 times as bright as measured. This sum follows measured daylight from noon to the
// end of twilight, and its table is small enough for a sun that moves.
#include "lighting/sun.glsl"
#include "sky/dome.glsl"
#include "sky/sight.glsl"
#pragma kernel(output = "dome:rgba32f")

uniform sampler2D place;         //! input
uniform sampler2D columns;       //! input
uniform sampler2D bounced;       //! input
uniform sampler2D air;           //! input

vec4 kernel(ivec2 texel) {
    int half_width = max(size.x / 2, 1);
    bool right = texel.x >= half_width;
    int rows = max(size.y / DOMES, 1);
    int table = min(texel.y / rows, DOMES - 1);
    float height = dome_height(table);
    vec2 share = vec2(right ? texel.x - half_width : texel.x, texel.y - table * rows)
            / vec2(max(ivec2(half_width, rows) - 1, 1));
    vec2 direction = dome_start(min(share, 1.0), height);
    vec3 sun = to_sun(texelFetch(place, ivec2(0), 0).rg);
    Air scatters = air_of(texelFetch(air, ivec2(0), 0).r);
    Sight seen = sight(columns, bounced, scatters, height, direction, sun);
    return vec4(right ? seen.aerosol : seen.molecules, 1.0);
}
