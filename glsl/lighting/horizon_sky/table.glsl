// lighting/horizon_sky/table.glsl -- what each of eight sectors of the sky adds.
//
//   gives    table: a vector whose product with the normal is the sector's part of K
//   needs    lighting/horizons/open_sky.glsl, maths/angle.glsl
//   units    shares of an open, even sky; texel i of a row is the tangent t with t / (1 + t) = i /
//            255
//   source   Belaiche 2010, section 3.4, eqs 3.13 to 3.15
//   tested   tests/glsl/test_sky.py, against quadrature
//
// The thesis's table of 256 x 8, by the sector's horizon.
//
// By the tangent, as the thesis advises; bent so that all tangents have a place. Rows are the
// sectors, counterclockwise from the first. 2 pi is already divided by.
#include "lighting/horizons/open_sky.glsl"
#include "maths/angle.glsl"
#pragma kernel(output = "table:rgba32f")

uniform float first = 0.0;    //! angle(-360, 360) unit("°") Azimuth of the first horizon

vec4 kernel(ivec2 texel) {
    float share = float(texel.x) / float(max(size.x - 1, 1));
    // The last place is a horizon straight up.
    vec2 open = share < 1.0 ? above_horizon(share / (1.0 - share)) : vec2(0.0);
    vec2 towards = cos_sin_degrees(first - 360.0 * float(texel.y) / float(size.y)).yx;
    return vec4(towards * (open.x * sector_shape(size.y)), open.y, 0.0) / float(size.y);
}
