// generation/gradient_noise/sum.comp -- hills of gradient noise, along columns of texels.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/gradient_noise/{parameters/octaves,seed}.glsl, noise/columns.glsl
//   units    heights without unit, as in the kernel next to it
//   source   see noise/columns.glsl
//   tested   tests/glsl/test_gradient_noise.py and tests/glsl/test_fast_variants.py,
//            against the kernel next to it
//   agrees   best at a low gain: both round places, in another order
//
// A thread goes along 32 rows of one column. The two finest octaves cross a lattice row every few
// texels; the coarser ones seldom do, so their sum is worked out apart, and moved along. Only
// the plain sum of Perlin noise goes this way; the rest is worked out texel by texel.
#include "noise/columns.glsl"
#include "generation/gradient_noise/seed.glsl"
#pragma compute(groups = "(size.x + 63) // 64, (size.y + 31) // 32", local = "64, 1", \
                overwrites = "height", agrees = "1e-4")

#include "generation/gradient_noise/parameters/octaves.glsl"

const int ROWS = 32;
const int FINE = 2;

void store(int x, int y, float height) {
    imageStore(out_height, ivec2(x, y), vec4(height, 0.0, 0.0, 1.0));
}

void main() {
    int x = int(gl_GlobalInvocationID.x);
    int y = int(gl_WorkGroupID.y) * ROWS;
    int last = min(y + ROWS, size.y);
    if (x >= size.x) return;
    float scale = cells_a_metre(frequency, extent, spacing);
    float texels = 1.0 / (scale * max(spacing.x, spacing.y));
    Octaves o = Octaves(basis, octaves, lacunarity, gain_of(strength, gain, hurst, lacunarity),
                        texels, octaves_seed(strength, seed));
    if (basis != PERLIN || shape != PLAIN) {
        for (; y < last; y++) {
            store(x, y, octaves_sum(shape, vec2(x, y) * (spacing * scale), o, warp).x);
        }
        return;
    }
    Rows rows = Rows(vec2(float(x) * (spacing.x * scale), 0.0), spacing.y * scale);
    // anchor: split
    int visible = 0;
    for (float finest = 1.0; visible < octaves && finest < texels; finest *= lacunarity) visible++;
    int split = max(visible - FINE, 0);
    Span coarse = octave_span(o, 0, split);
    Span fine = octave_span(o, split, visible);
    // end: split
    if (visible == 0) fine.strength = 0.0;
    do {
        int stop = last;
        if (split > 0) stop = min(stop, column_end(rows, y, o, coarse));
        float around = 0.5 * float(y + stop - 1);
        Column smooth_part = Column(vec4(0.0), vec3(0.0));
        if (split > 0) smooth_part = column_add(smooth_part, rows, around, o, coarse);
        do {
            int end = min(stop, column_end(rows, y, o, fine));
            float middle = 0.5 * float(y + end - 1);
            Column piece = column_moved(smooth_part, middle - around);
            piece = column_add(piece, rows, middle, o, fine);
            do {
                store(x, y, column_height(piece, float(y) - middle));
                y++;
            } while (y < end);
        } while (y < stop);
    } while (y < last);
}
