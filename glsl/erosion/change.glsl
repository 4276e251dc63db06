// erosion/change.glsl -- how much lower and how much higher the ground is than it was.
//
//   gives    wear and deposit, never below 0
//   needs    maths/land.glsl; the height now and before
//   units    metres
//   source   none: made here
//   tested   tests/glsl/test_thermal.py, against the difference in NumPy
#include "maths/land.glsl"
#pragma kernel(output = "wear:r32f, deposit:r32f")

uniform sampler2D height;  //! input
uniform sampler2D before;  //! input

float at(sampler2D field, ivec2 texel) {
    ivec2 grid = textureSize(field, 0);
    return texelFetch(field, ivec2(place_on(grid, texel, size) + 0.5), 0).r;
}

void kernel(ivec2 texel, out float wear, out float deposit) {
    float rise = relief * (at(height, texel) - at(before, texel));
    wear = max(-rise, 0.0);
    deposit = max(rise, 0.0);
}
