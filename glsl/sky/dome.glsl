// sky/dome.glsl -- the table of the sky over the ground: its axes, and reading it in any direction.
//
//   gives    dome_start, dome_at
//   needs    sky/air.glsl; a table made by lighting/daylight/dome, perhaps with rows of something else below
//   units    directions are unit vectors, x east, y north, z up; light as in the table
//   source   made here; that the aerosol's phase is left to the reader: Bruneton and Neyret 2008,
//            "Precomputed Atmospheric Scattering", section 4
//   tested   tests/glsl/test_air.py, against light worked out in each direction in float64
//
// The left half holds what molecules scatter, and all that was scattered more than once; the
// right half what aerosol scatters, without its phase, which is too sharp for so few texels.
// Along x, in each half: from the sun's side round to the other, which is the same on both
// ways. Along y: from the horizon to the zenith. Both are closest where the sky changes most.
#ifndef SKY_DOME
#define SKY_DOME
#include "sky/air.glsl"

// The sine of the elevation, and the cosine of the azimuth from the sun's, both of a share 0..1.
vec2 dome_start(vec2 share) {
    return vec2(share.y * share.y, 1.0 - 2.0 * share.x * share.x);
}

// What is seen in a direction; the table begins at row `foot`. Below the horizon: what is on it.
vec3 dome_at(sampler2D table, int foot, vec3 direction, vec3 sun) {
    float level = length(direction.xy) * length(sun.xy);
    float aside = level > 1e-9 ? clamp(dot(direction.xy, sun.xy) / level, -1.0, 1.0) : 0.0;
    vec2 share = sqrt(vec2(0.5 - 0.5 * aside, clamp(direction.z, 0.0, 1.0)));
    ivec2 whole = textureSize(table, 0);
    ivec2 last = max(ivec2(whole.x / 2, whole.y - foot) - 1, 0);
    vec2 place = share * vec2(last);
    ivec2 low = ivec2(place);
    ivec2 high = min(low + 1, last);
    vec2 part = place - vec2(low);
    vec4 weight = vec4(1.0 - part.x, part.x, 1.0 - part.x, part.x) * vec4(1.0 - part.yy, part.yy);
    vec3 found = vec3(0.0);
    float phase = phase_aerosol(dot(direction, sun));
    for (int half_of = 0; half_of < 2; half_of++) {
        int left = half_of * (last.x + 1);
        vec3 mean = weight.x * texelFetch(table, ivec2(left + low.x, foot + low.y), 0).rgb
                  + weight.y * texelFetch(table, ivec2(left + high.x, foot + low.y), 0).rgb
                  + weight.z * texelFetch(table, ivec2(left + low.x, foot + high.y), 0).rgb
                  + weight.w * texelFetch(table, ivec2(left + high.x, foot + high.y), 0).rgb;
        found += mean * (half_of == 0 ? 1.0 : phase);
    }
    return found;
}
#endif
