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
// A thread goes along 32 rows of four columns. The two finest octaves cross a lattice row every few
// texels; the coarser ones seldom do, so their sum is worked out apart, and moved along. Only
// the plain sum of Perlin noise goes this way; the rest is worked out texel by texel.
#include "noise/columns.glsl"
#include "generation/gradient_noise/seed.glsl"
#pragma compute(where = "fours = (size.x + 3) // 4", local = "16, 1", \
                groups = "(fours + 15) // 16, (size.y + 31) // 32", \
                buffers = "height:vec4:fours * size.y", aligned = "16", \
                overwrites = "height", agrees = "1e-4")

#include "generation/gradient_noise/parameters/octaves.glsl"

const int ROWS = 32;
const int FINE = 2;

void main() {
    int fours = (size.x + 3) >> 2;
    int four = int(gl_GlobalInvocationID.x);
    int y = int(gl_WorkGroupID.y) * ROWS;
    int last = min(y + ROWS, size.y);
    if (four >= fours) return;
    vec4 x = float(4 * four) + vec4(0.0, 1.0, 2.0, 3.0);
    float scale = cells_a_metre(frequency, extent, spacing);
    float texels = 1.0 / (scale * max(spacing.x, spacing.y));
    Octaves o = Octaves(basis, octaves, lacunarity, gain_of(strength, gain, hurst, lacunarity),
                        texels, octaves_seed(strength, seed));
    int at = y * fours + four;
    if (basis != PERLIN || shape != PLAIN) {
        for (; y < last; y++) {
            vec4 found;
            for (int i = 0; i < 4; i++) {
                found[i] = octaves_sum(shape, vec2(x[i], y) * (spacing * scale), o, warp).x;
            }
            height[at] = found;
            at += fours;
        }
        return;
    }
    Rows rows = Rows(x * (spacing.x * scale), spacing.y * scale);
    // anchor: split
    int visible = 0;
    for (float finest = 1.0; visible < octaves && finest < texels; finest *= lacunarity) visible++;
    int split = max(visible - FINE, 0);
    Span coarse = octave_span(o, 0, split);
    Span fine = octave_span(o, split, visible);
    // end: split
    if (visible == 0) fine.strength = 0.0;
    vec4 none = vec4(0.0);
    do {
        int stop = last;
        if (split > 0) stop = min(stop, columns_end(rows, y, o, coarse));
        float around = 0.5 * float(y + stop - 1);
        Columns smooth_part = Columns(none, none, none, none, none, none, none);
        if (split > 0) smooth_part = columns_add(smooth_part, rows, around, o, coarse);
        do {
            int end = min(stop, columns_end(rows, y, o, fine));
            float middle = 0.5 * float(y + end - 1);
            Columns piece = columns_moved(smooth_part, middle - around);
            piece = columns_add(piece, rows, middle, o, fine);
            do {
                height[at] = columns_height(piece, float(y) - middle);
                at += fours;
                y++;
            } while (y < end);
        } while (y < stop);
    } while (y < last);
}
