// lighting/mean_filter/line.glsl -- the mean of the light along one axis.
//
//   gives    light, alpha as well
//   needs    maths/whole.glsl
//   units    as the light
//   source   Belaiche 2010, section 3.5.2
//   tested   tests/glsl/test_filters.py, against sums of slices in NumPy
//
// It is that of a window around each texel, or of the texel's patch.
//
// The mean over a square is the mean over rows of the means over columns, also at the border,
// where what is left of the square is still a rectangle: two passes of this are the filter.
#include "maths/whole.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D light; //! input
uniform int n = 4;       //! slider(0, 64)
                         //! Texels to each side of a window, or along a patch's side. 0: the light
                         //! as it is
uniform int area = 0;    //! menu("window", "patch")
                         //! A window goes with each texel; patches lie side by side, and each has
                         //! one light
uniform int axis = 0;    //! menu("x", "y") Along which axis

vec4 kernel(ivec2 texel) {
    ivec2 along = axis == 0 ? ivec2(1, 0) : ivec2(0, 1);
    int place = axis == 0 ? texel.x : texel.y;
    int last = (axis == 0 ? size.x : size.y) - 1;
    int side = max(n, 1);
    int low = area == 0 ? max(place - n, 0) : quotient(place, side) * side;
    int high = min(area == 0 ? place + n : low + side - 1, last);
    vec4 total = vec4(0.0);
    for (int k = low; k <= high; k++) total += texelFetch(light, texel + (k - place) * along, 0);
    return total / float(high - low + 1);
}
