// generation/diamond_square/known.glsl -- which step of diamond-square sets each texel.
//
//   gives    phase: 0 for a texel that is not set yet, 1 for the corners, 2 for the first
//            centres, 3 for the first edges, 4 for the second centres, ..
//   needs    generation/diamond_square/lattice.glsl
//   units    whole numbers
//   source   Belaiche 2010, section 1.3.2, figures 1.8 to 1.11
//   tested   tests/glsl/test_halving.py: how many texels each step sets, and which
//
// Its steps are those of generation/diamond_square/raw.glsl: both stopped after as many steps
// are one picture of the algorithm on its way.
#include "generation/diamond_square/lattice.glsl"
#pragma kernel(output = "phase:r32f", \
               accepts = "2**n + 1", repeat = "2 * log2(size.x - 1) + 1", \
               where = "spacings = 2**((iteration + 1) // 2)", \
               visits = "spacings + 1, spacings + 1", \
               stride = "(size.x - 1) // spacings")

float kernel(ivec2 texel) {
    return is_set_by(texel, iteration, size.x - 1) ? float(iteration + 1) : previous(texel);
}

ivec2 visit(ivec2 cell) {
    ivec2 texel = cell * half_spacing(iteration, size.x - 1);
    return is_set_by(texel, iteration, size.x - 1) ? texel : ivec2(-1);
}
