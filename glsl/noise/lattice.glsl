// noise/lattice.glsl -- random bits at the points of a lattice, cheaper than a hash each.
//
//   gives    lattice_seed, lattice_columns, lattice_rows
//   needs    nothing: pure functions, no uniforms, no textures
//   units    whole numbers modulo 2^32
//   source   the mixing steps and their multipliers: C. Wellons 2018, "Prospecting for Hash
//            Functions" (lowbias32, public domain); products of two mixed numbers: made here
//   tested   tests/glsl/test_gradient_noise.py, against Python's whole numbers and against the
//            statistics that random numbers must have
//
// The bits of a point are the product of a number of its column and a number of its row:
//
//     lattice_columns(x, seed).x * lattice_rows(y, seed).x
//
// The corners of a cell share those: four mixes and four products, where a hash for each of
// the corners mixes twice as long. Both numbers are odd, so that neither takes bits from the
// other. As in any product the upper bits are the good ones: read the bits as a signed share
// of a turn, or take the upper half; never the lower.
#ifndef NOISE_LATTICE
#define NOISE_LATTICE

// Odd numbers from keys, one round of mixing: enough before a product.
uvec2 lattice_mixed(uvec2 key) {
    key = (key ^ (key >> 15u)) * 0x7feb352du;
    return key | 1u;
}

// The numbers of column x and of the next one.
uvec2 lattice_columns(int x, uint seed) {
    uint key = uint(x) * 0x9e3779b1u + seed;
    return lattice_mixed(uvec2(key, key + 0x9e3779b1u));
}

// The numbers of row y and of the next one; another multiplier, or the lattice would be its own
// mirror image.
uvec2 lattice_rows(int y, uint seed) {
    uint key = uint(y) * 0x85ebca77u + seed;
    return lattice_mixed(uvec2(key, key + 0x85ebca77u));
}

// A seed for one of several lattices of a terrain. Seeds need no mixing: a seed moves columns and
// rows by different steps through all there are, and steps that bring both to less than
// 29 000 cells of another seed's do not exist. So seeds are windows that never overlap.
uint lattice_seed(uint seed, int which) {
    return seed * 0x2545f491u + uint(which) * 0xc2b2ae3du;
}
#endif
