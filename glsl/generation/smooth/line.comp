// generation/smooth/line.comp -- the mean along one axis by a sum that slides.
//
//   gives    height
//   needs    nothing
//   units    as the heights
//   source   a moving sum; derived here
//   tested   tests/glsl/test_filters.py, against sums of slices in NumPy
//   agrees   for heights in 0..1: the sum gathers roundings as it slides
//
// Each thread goes along a run of texels, with two fetches a texel at any radius: it sums one
// whole window, then adds what comes in and takes away what goes out. A run is as long as its
// first window, so that the window costs no more than the rest; it begins anew at each run, so
// that roundings cannot gather for long. Threads that lie beside each other go beside each other.
#pragma compute(where = "lines = size.y if axis == 0 else size.x; \
                         texels = size.x if axis == 0 else size.y; \
                         run = max(64, 2 * radius + 1)", \
                groups = "(lines + 31) // 32, (texels - 1) // run + 1", local = "32, 1", \
                agrees = "2e-6")

uniform sampler2D height; //! input
uniform int radius = 5;   //! slider(0, 512) unit("texels") As in the technique
uniform int axis = 0;     //! menu("x", "y") Along which axis

ivec2 texel_at(int place, int line) {
    return axis == 0 ? ivec2(place, line) : ivec2(line, place);
}

void main() {
    int line = int(gl_GlobalInvocationID.x);
    if (line >= (axis == 0 ? size.y : size.x)) return;
    int last = (axis == 0 ? size.x : size.y) - 1;
    int run = max(64, 2 * radius + 1);
    int from = int(gl_GlobalInvocationID.y) * run;
    int to = min(from + run - 1, last);
    // The first height is taken away from all: what is summed is small, and so are its roundings.
    float level = texelFetch(height, texel_at(from, line), 0).r;
    int low = max(from - radius, 0);
    int high = min(from + radius, last);
    float total = 0.0;
    for (int k = low; k <= high; k++) {
        total += texelFetch(height, texel_at(k, line), 0).r - level;
    }
    for (int place = from; place <= to; place++) {
        float mean = level + total / float(high - low + 1);
        imageStore(out_height, texel_at(place, line), vec4(mean));
        if (place - radius >= 0) total -= texelFetch(height, texel_at(low++, line), 0).r - level;
        if (high < last) total += texelFetch(height, texel_at(++high, line), 0).r - level;
    }
}
