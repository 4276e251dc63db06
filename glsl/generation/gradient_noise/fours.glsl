// generation/gradient_noise/fours.glsl -- hills of gradient noise, along four columns at once.
//
//   gives    make_fours
//   needs    noise/columns.glsl; generation/normalise/tell.glsl; the parameters of a sum of
//            octaves but its gain, declared before it, and a buffer `height:vec4`,
//            (size.x + 3) / 4 fours a row
//   units    heights without unit, as those of generation/gradient_noise/sum.glsl
//   source   see noise/columns.glsl
//   tested   tests/glsl/test_gradient_noise.py and tests/glsl/test_fast_variants.py, as part of
//            the fast variants
//
// Only for speed. A thread goes along 32 rows of four columns. The two finest octaves cross a
// lattice row every few texels; the coarser ones seldom do, so their sum is worked out apart, and
// moved along. Only the plain sum of Perlin noise goes this way; the rest is worked out texel by
// texel. Columns beyond the terrain are its last one.
#ifndef GENERATION_GRADIENT_NOISE_FOURS
#define GENERATION_GRADIENT_NOISE_FOURS
#ifdef COMPUTE_STAGE
#include "noise/columns.glsl"
#include "generation/normalise/tell.glsl"

const int ROWS = 32;
const int FINE = 2;

// The fours of one number in their rows, from row `y` on; what `tells` has their range told.
void make_fours(int four, int y, float gain, uint salted_seed, bool tells) {
    int fours = (size.x + 3) >> 2;
    int last = min(y + ROWS, size.y);
    if (four >= fours) return;
    Told told = nothing_told();
    vec4 x = vec4(min(4 * four + ivec4(0, 1, 2, 3), ivec4(size.x - 1)));
    float scale = cells_a_metre(frequency, extent, spacing);
    float texels = 1.0 / (scale * max(spacing.x, spacing.y));
    Octaves o = Octaves(basis, octaves, lacunarity, gain, texels, salted_seed);
    int at = y * fours + four;
    if (basis != PERLIN || shape != PLAIN) {
        for (; y < last; y++) {
            vec4 found;
            for (int i = 0; i < 4; i++) {
                found[i] = octaves_sum(shape, vec2(x[i], y) * (spacing * scale), o, warp).x;
            }
            height[at] = found;
            told = told_also(told, found);
            at += fours;
        }
        if (tells) tell(told);
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
                vec4 found = columns_height(piece, float(y) - middle);
                height[at] = found;
                if (tells) told = told_also(told, found);
                at += fours;
                y++;
            } while (y < end);
        } while (y < stop);
    } while (y < last);
    if (tells) tell(told);
}
#endif
#endif
