// view/profile/line.glsl -- elevations under a straight line, from its start to its finish.
//
//   gives    height, in metres above sea level, a row of it
//   needs    terrain/heightfield.glsl; a height
//   units    ends as shares of the terrain, east and north
//   source   none: heights between texels, as every kernel reads them
//   tested   tests/glsl/test_view_profile.py, against interpolation in float64
#include "terrain/heightfield.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D height;  //! input

#include "view/parameters/profile_line.glsl"

float kernel(ivec2 texel) {
    vec2 share = mix(start, finish, float(texel.x) / float(max(size.x - 1, 1)));
    return base_elevation + relief * height_at(height, share * vec2(textureSize(height, 0) - 1));
}
