// sky/dome.glsl -- the table of the sky as seen from several heights.
//
//   gives    DOMES, dome_height, dome_between, dome_start, dome_at
//   needs    sky/air.glsl, sky/shell.glsl; a table made by lighting/daylight/dome, perhaps with
//            rows of something else below
//   units    directions are unit vectors, x east, y north, z up; heights of the eye over the sea
//            in kilometres; light as in the table
//   source   made here; that the aerosol's phase is left to the reader: Bruneton and Neyret 2008,
//            "Precomputed Atmospheric Scattering", section 4
//   tested   tests/glsl/test_air.py, against light worked out in each direction in float64
//
// Here are its axes, and how it is read in any direction.
//
// The left half holds what molecules scatter, and all that was scattered more than once; the
// right half what aerosol scatters, without its phase, which is too sharp for so few texels.
// Along x, in each half: from the sun's side round to the other, which is the same on both
// sides. Along y: from the horizon to the zenith. Both are closest where the sky changes most. One
// such table is over the other for each of several heights, closest near the sea: from 600 m
// a third more blue comes from the horizon, since half of the haze is below. The horizon lies
// lower from higher up.
#ifndef SKY_DOME
#define SKY_DOME
#include "sky/air.glsl"
#include "sky/shell.glsl"

const int DOMES = 9;
const float HIGHEST_DOME = 16.0;

// The height of the eye for each table.
float dome_height(int dome) {
    float share = float(dome) / float(DOMES - 1);
    return HIGHEST_DOME * share * share;
}

// Between which tables a height lies, as a number of tables.
float dome_between(float height) {
    return float(DOMES - 1) * sqrt(clamp(height / HIGHEST_DOME, 0.0, 1.0));
}

// The sine of the elevation from a height, and the cosine of the azimuth from the sun's, both of a
// share 0..1.
vec2 dome_start(vec2 share, float height) {
    float lowest = horizon_rise(height);
    return vec2(lowest + (1.0 - lowest) * share.y * share.y, 1.0 - 2.0 * share.x * share.x);
}

// What one table has at a place, 0..1 along both axes; its rows begin at `foot`.
vec3 dome_of(sampler2D table, int foot, int rows, vec2 share, float phase) {
    ivec2 last = max(ivec2(textureSize(table, 0).x / 2, rows) - 1, 0);
    vec2 place = share * vec2(last);
    ivec2 low = ivec2(place);
    ivec2 high = min(low + 1, last);
    vec2 part = place - vec2(low);
    vec4 weight = vec4(1.0 - part.x, part.x, 1.0 - part.x, part.x) * vec4(1.0 - part.yy, part.yy);
    vec3 found = vec3(0.0);
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

// What is seen in a direction from a height; below the horizon: what is on it. The tables begin at
// row `foot`. Between two, what is as far over the horizon of each.
vec3 dome_at(sampler2D table, int foot, vec3 direction, vec3 sun, float height) {
    float level = length(direction.xy) * length(sun.xy);
    float aside = level > 1e-9 ? clamp(dot(direction.xy, sun.xy) / level, -1.0, 1.0) : 0.0;
    float lowest = horizon_rise(height);
    vec2 share = sqrt(vec2(0.5 - 0.5 * aside,
                           clamp((direction.z - lowest) / (1.0 - lowest), 0.0, 1.0)));
    float phase = phase_aerosol(dot(direction, sun));
    int rows = (textureSize(table, 0).y - foot) / DOMES;
    float place = dome_between(height);
    int low = int(place);
    vec3 found = dome_of(table, foot + low * rows, rows, share, phase);
    if (place == float(low)) return found;
    return mix(found, dome_of(table, foot + (low + 1) * rows, rows, share, phase),
               place - float(low));
}
#endif
