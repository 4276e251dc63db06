// generation/diamond_square/lattice.glsl -- which texels a step of diamond-square sets.
//
//   gives    DIAMOND_SQUARE_SALT, half_spacing, is_set_by
//   needs    nothing: pure functions, no uniforms, no textures
//   units    texels; steps from 0; a side is a power of two, one less than a terrain's texels
//   source   Belaiche 2010, sections 1.3.2 and 4.3.1
//   tested   tests/glsl/test_halving.py, against the thesis's loops
//
// Step 0 sets the four corners. Then each spacing s = side, side/2, .. 2 has two steps:
//   centres   (odd steps)   every texel in the middle of four known ones, s/2 diagonally away
//   edges     (even steps)  every texel between known ones, s/2 along the axes
#ifndef GENERATION_DIAMOND_SQUARE_LATTICE
#define GENERATION_DIAMOND_SQUARE_LATTICE

const uint DIAMOND_SQUARE_SALT = 0xfaac44f9u;  // CRC-32 of "generation/diamond_square"

// Half the spacing of a step, a power of two: half the side for steps 1 and 2, a quarter for 3
// and 4, ..
int half_spacing(int which, int side) {
    return side >> ((which + 1) >> 1);
}

// Whether a step sets a texel. Masks, not division: a side is a power of two.
bool is_set_by(ivec2 texel, int which, int side) {
    if (which == 0) return (texel.x == 0 || texel.x == side) && (texel.y == 0 || texel.y == side);
    int r = half_spacing(which, side);
    if (((texel.x | texel.y) & (r - 1)) != 0) return false;
    bool between_x = (texel.x & r) != 0;
    bool between_y = (texel.y & r) != 0;
    return (which & 1) == 1 ? between_x && between_y : between_x != between_y;
}
#endif
