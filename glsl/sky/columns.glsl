// sky/columns.glsl -- how much air sunlight crosses, from a table.
//
//   gives    column_start, column_at, risen, left_of_sunlight
//   needs    sky/air.glsl, sky/shell.glsl; a table made by lighting/daylight/columns
//   units    kilometres of sea level's air (of ozone's densest); rises as in sky/shell.glsl;
//            sunlight 0..1 of that outside the air
//   source   table's axes: Bruneton and Neyret 2008, "Precomputed Atmospheric Scattering",
//            section 4, as in the 2017 revision; the disc's part above the horizon as there
//   tested   tests/glsl/test_air.py, against integrals in float64
//
// It tells what is left of sunlight.
//
// Along x: how far the top of the air is, from straight up to the horizon. Along y: how far
// the horizon is, from the ground to the top. Both vary fast just where the columns do.
#ifndef SKY_COLUMNS
#define SKY_COLUMNS
#include "sky/air.glsl"
#include "sky/shell.glsl"

const float HORIZON_MOST = 1132.254;  // from the top of the air [km]: sqrt(100 (2 · 6360 + 100))

// The height and the rise that a place in the table represents, both 0..1.
vec2 column_start(vec2 share) {
    float far = share.y * HORIZON_MOST;
    float height = far * far / (sqrt(far * far + EARTH_RADIUS * EARTH_RADIUS) + EARTH_RADIUS);
    float shortest = AIR_HEIGHT - height;
    float path = mix(shortest, far + HORIZON_MOST, share.x);
    if (path < 1e-3) return vec2(height, 1.0);
    float rise = (HORIZON_MOST * HORIZON_MOST - far * far - path * path)
            / (2.0 * (EARTH_RADIUS + height) * path);
    return vec2(height, clamp(rise, -1.0, 1.0));
}

// The columns of molecules, aerosol and ozone from a height to the top, along a path that misses
// the ground.
vec3 column_at(sampler2D columns, float height, float rise) {
    float far = sqrt(max(height * (2.0 * EARTH_RADIUS + height), 0.0));
    float shortest = AIR_HEIGHT - height;
    float longest = far + HORIZON_MOST;
    vec2 share = vec2((distance_to_top(height, rise) - shortest) / (longest - shortest),
                      far / HORIZON_MOST);
    ivec2 last = textureSize(columns, 0) - 1;
    vec2 place = clamp(share, 0.0, 1.0) * vec2(last);
    ivec2 low = ivec2(place);
    ivec2 high = min(low + 1, last);
    vec2 part = place - vec2(low);
    vec3 south = mix(texelFetch(columns, low, 0).rgb,
                     texelFetch(columns, ivec2(high.x, low.y), 0).rgb, part.x);
    vec3 north = mix(texelFetch(columns, ivec2(low.x, high.y), 0).rgb,
                     texelFetch(columns, high, 0).rgb, part.x);
    return mix(south, north, part.y);
}

// How much of the sun's disc is over the horizon: it sets in its own width, not at once. Its
// rim is taken as straight.
float risen(float height, float rise) {
    return clamp(0.5 + 0.5 * (rise - horizon_rise(height)) / radians(SUN_RADIUS), 0.0, 1.0);
}

// What is left of the sun's light at a height where the sun is at this rise.
// anchor: left
vec3 left_of_sunlight(sampler2D columns, Air air, float height, float rise) {
    vec3 depth = extinction(air, column_at(columns, height, max(rise, horizon_rise(height))));
    return risen(height, rise) * exp(-min(depth, 50.0));
}
// end: left
#endif
