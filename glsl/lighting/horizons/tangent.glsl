// lighting/horizons/tangent.glsl -- the horizon in one direction: the steepest line to terrain.
//
//   gives    tangent: of the horizon's elevation, 0 and up
//   needs    lighting/march.glsl, maths/angle.glsl
//   units    tangents are rises over runs
//   source   Belaiche 2010, section 3.4, after Max 1988, "Horizon Mapping: Shadows for Bump-Mapped
//            Surfaces"
//   tested   tests/glsl/test_one_horizon.py, against brute force in float64 and lighting/horizons
//
// One of the horizons that lighting/horizons keeps for all directions.
#include "lighting/march.glsl"
#include "maths/angle.glsl"
#pragma kernel(output = "tangent:r32f", relief = "shown")

uniform sampler2D height;       //! input
uniform float azimuth = 270.0;  //! angle(0, 360) The direction looked in, clockwise from north

float kernel(ivec2 texel) {
    vec3 level = vec3(cos_sin_degrees(azimuth).yx, 0.0);  // east, north, up
    // anchor: march
    March march = march_from(height, vec2(texel), level, extent, relief, 1.0);
    float steepest = 0.0;
    for (int i = 1; i <= march.count; i++) {
        float rise = terrain_at(height, march, i, INTERPOLATED) - march.foot;
        float run = float(i) * march.run;
        steepest = max(steepest, rise / run);
    }
    return steepest;
    // end: march
}
