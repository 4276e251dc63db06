// lighting/sun.glsl -- where the sun is, and how much of it a surface turned some way receives.
//
//   gives    to_sun, normal_of_slope, sun_on
//   needs    maths/angle.glsl
//   units    azimuth clockwise from north and elevation above the horizon, in degrees;
//            x east, y north, z up; slopes in metres over metres; received light 0..1
//   source   Lambert's cosine law, as in Belaiche 2010, sections 3.5.3 and 3.3 (eq. 3.1)
//   tested   tests/glsl/test_lighting.py, against compass points and rotations in float64
//
// The thesis turns its light vector round between methods, and its sign with it. Here there
// is one vector, from the terrain towards the sun.
#ifndef LIGHTING_SUN
#define LIGHTING_SUN
#include "maths/angle.glsl"

// The unit vector towards the sun.
vec3 to_sun(vec2 azimuth_elevation) {
    vec2 around = cos_sin_degrees(azimuth_elevation.x);
    vec2 above = cos_sin_degrees(azimuth_elevation.y);
    return vec3(around.y * above.x, around.x * above.x, above.y);
}

// The unit vector out of a surface that rises by `slope` to the east and to the north.
vec3 normal_of_slope(vec2 slope) {
    return normalize(vec3(-slope, 1.0));
}

// anchor: lambert
// The sun's light on a surface, 1 where it falls straight on it. A sun below the horizon
// lights nothing, not even slopes that face it: the terrain itself is in the way.
float sun_on(vec3 normal, vec3 sun) {
    return sun.z < 0.0 ? 0.0 : max(0.0, dot(normal, sun));
}
// end: lambert
#endif
