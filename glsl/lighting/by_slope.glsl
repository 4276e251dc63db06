// lighting/by_slope.glsl -- L·N of a texture of slopes, wherever they come from.
//
//   gives    light
//   needs    maths/land.glsl, lighting/sun.glsl; a slope, height per metre
//   units    light without unit, 1 for white
//   source   Lambert's cosine law, as in Belaiche 2010, section 3.5.3
//   tested   tests/glsl/test_slopes.py, against inclined planes
//
// lighting/l_dot_n takes the slope from the heights. Here it is an input, so that differences and
// analytic derivatives can be seen side by side, and a light finer than the heights has its
// slopes from where the heights come from.
#include "lighting/sun.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D slope;               //! input("linear")
uniform vec2 sun = vec2(315.0, 40.0);  //! direction group("Sun")
                                       //! Azimuth clockwise from north, elevation above the
                                       //! horizon
#include "lighting/parameters/sunlight.glsl"
#include "lighting/parameters/skylight.glsl"

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(slope, 0);
    vec2 uv = (place_on(grid, texel, size) + 0.5) / vec2(grid);
    vec2 rise = relief * textureLod(slope, uv, 0.0).rg;
    // anchor: light
    vec3 normal = normal_of_slope(rise);
    float received = gain * sun_on(normal, towards_sun);
    // end: light
    return vec4(sun_colour * received + sky_colour * ambient, 1.0);
}
