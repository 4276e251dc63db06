// terrain/normal_angle.glsl -- the angle between the normals of two textures of slopes.
//
//   gives    angle
//   needs    maths/land.glsl, lighting/sun.glsl; two slopes, height per metre
//   units    degrees
//   source   derived here
//   tested   tests/glsl/test_slopes.py, against planes
//
// By the tangent: the cosine of a small angle is 1 to all its digits.
#include "lighting/sun.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "angle:r32f")

uniform sampler2D slope;  //! input
uniform sampler2D other;  //! input

vec3 normal_at(sampler2D slopes, ivec2 texel) {
    ivec2 place = ivec2(place_on(textureSize(slopes, 0), texel, size) + 0.5);
    return normal_of_slope(relief * texelFetch(slopes, place, 0).rg);
}

float kernel(ivec2 texel) {
    vec3 one = normal_at(slope, texel);
    vec3 two = normal_at(other, texel);
    return degrees(atan(length(cross(one, two)), dot(one, two)));
}
