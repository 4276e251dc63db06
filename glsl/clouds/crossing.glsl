// clouds/crossing.glsl -- where a line of sight is within a layer that is round as the Earth is.
//
//   gives    layer_crossing, NO_CROSSING, over_horizon
//   needs    sky/shell.glsl
//   units    kilometres; `rise` is the cosine between the path and the vertical at its start
//   source   the law of cosines, as in sky/shell.glsl: where nothing cancels
//   tested   tests/glsl/test_cloud_pictures.py, against float64
#ifndef CLOUDS_CROSSING
#define CLOUDS_CROSSING
#include "sky/shell.glsl"

const vec2 NO_CROSSING = vec2(1.0, 0.0);
const float HORIZON_MARGIN = 0.02;

// With a = (R + h) rise and x = (H - h) (2R + H + h), height H is reached after -a ± sqrt(a² + x).
float distance_over(float along, float x) {
    float root = sqrt(max(along * along + x, 0.0));
    return along >= 0.0 ? x / max(root + along, 1e-9) : root - along;
}

float distance_under(float along, float x) {
    return -x / max(sqrt(max(along * along + x, 0.0)) - along, 1e-9);
}

// From where to where a path first is between two heights; NO_CROSSING if the ground comes first.
vec2 layer_crossing(float from, float rise, float base, float top) {
    float along = (EARTH_RADIUS + from) * rise;
    float to_base = (base - from) * (2.0 * EARTH_RADIUS + base + from);
    float to_top = (top - from) * (2.0 * EARTH_RADIUS + top + from);
    bool under_base = rise < 0.0 && along * along + to_base >= 0.0;
    if (from < base) {
        if (distance_to_ground(max(from, 0.0), rise) >= 0.0) return NO_CROSSING;
        return vec2(distance_over(along, to_base), distance_over(along, to_top));
    }
    if (from <= top) {
        return vec2(0.0, under_base ? distance_under(along, to_base)
                                    : distance_over(along, to_top));
    }
    if (rise >= 0.0 || along * along + to_top < 0.0) return NO_CROSSING;
    return vec2(distance_under(along, to_top),
                under_base ? distance_under(along, to_base) : distance_over(along, to_top));
}

// A direction from below the layer, and if it is no more than HORIZON_MARGIN under the horizon,
// that of the horizon: a picture of clouds that is read between its pixels goes on there.
vec3 over_horizon(vec3 ahead, float from, float base) {
    float lowest = horizon_rise(max(from, 0.0)) + 1e-5;
    if (from >= base || ahead.z >= lowest || ahead.z < lowest - HORIZON_MARGIN) return ahead;
    float level = sqrt(1.0 - lowest * lowest) / length(ahead.xy);
    return vec3(ahead.xy * level, lowest);
}
#endif
