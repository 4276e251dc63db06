// lighting/daylight/columns.glsl -- how much air there is above, in every direction.
//
//   gives    columns: of molecules, aerosol and ozone; the same on every day, so made once
//   needs    sky/columns.glsl
//   units    kilometres of sea level's air, of ozone's densest
//   source   the integral of sky/air.glsl's densities by the midpoint rule
//   tested   tests/glsl/test_air.py, against a finer integral in float64
//
// From every height to the top of the air.
#include "sky/columns.glsl"
#pragma kernel(output = "columns:rgba32f")

const int STEPS = 96;

vec4 kernel(ivec2 texel) {
    vec2 start = column_start(vec2(texel) / vec2(max(size - 1, 1)));
    float whole = distance_to_top(start.x, start.y);
    vec3 total = vec3(0.0);
    for (int k = 0; k < STEPS; k++) {
        // Steps grow along the path, since most of the air is near its start.
        float share = (float(k) + 0.5) / float(STEPS);
        float height = max(height_along(start.x, start.y, whole * share * share), 0.0);
        total += densities(height) * (2.0 * share * whole / float(STEPS));
    }
    return vec4(total, 1.0);
}
