// generation/smooth/line.glsl -- the mean of the heights around each texel, along one axis.
//
//   gives    height
//   needs    nothing
//   units    as the heights
//   source   Belaiche 2010, section 1.3.9 (the filter of figure 1.36); one axis of it
//   tested   tests/glsl/test_filters.py, against sums of slices in NumPy
//
// The mean over a square is the mean over rows of the means over columns, also at the border,
// where what is left of the square is still a rectangle: two passes of this are the filter.
#pragma kernel(output = "height:r32f")

uniform sampler2D height; //! input
uniform int radius = 5;   //! slider(0, 512) unit("texels") To each side that are averaged; 5 is a
                          //! mean of 11. With twice as many texels a side it is half as wide
uniform int axis = 0;     //! menu("x", "y") Along which axis

float kernel(ivec2 texel) {
    ivec2 step_on = axis == 0 ? ivec2(1, 0) : ivec2(0, 1);
    int place = axis == 0 ? texel.x : texel.y;
    int last = (axis == 0 ? size.x : size.y) - 1;
    int low = max(place - radius, 0);
    int high = min(place + radius, last);
    ivec2 at = texel + (low - place) * step_on;
    // Its own height is taken away from all: what is summed is small, and so are its roundings.
    float level = texelFetch(height, texel, 0).r;
    float total = 0.0;
    for (int k = low; k <= high; k++) {
        total += texelFetch(height, at, 0).r - level;
        at += step_on;
    }
    return level + total / float(high - low + 1);
}
