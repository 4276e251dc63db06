// generation/midpoint_displacement/raw.glsl -- terrain by displacing midpoints of squares.
//
//   gives    height, for any terrain of 2^n + 1 texels a side; not normalised
//   needs    noise/finest.glsl, noise/hash.glsl
//   units    heights without unit
//   source   Belaiche 2010, section 1.3.5
//   tested   tests/glsl/test_halving.py, against squares that are divided one by
//            one, in float64 with the same hash
//
// The terrain begins as 0 everywhere. Each step divides every square in four: the middle of an
// edge is the mean of its two corners, the centre that of all four, and to each is added a
// random number in [-d, d]. The first step's d is 1, each next step's `roughness` times the
// one before: the thesis names the factor for its next technique, "as for midpoint
// displacement", and gives no value.
#include "noise/finest.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f", where = "squares = 2**(iteration + 1)", \
               repeat = "log2(size.x - 1)", accepts = "2**n + 1", \
               visits = "squares + 1, squares + 1", stride = "(size.x - 1) // squares", \
               between = "squares")

uniform float roughness = 0.5;  //! slider(0, 1) step(0.01) Each step's random numbers, over those
                                //! of the step before
uniform uint seed = 7u;         //! slider(0, 9999) Which terrain

const uint SALT = 0x370b75bau;  // CRC-32 of "generation/midpoint_displacement"

ivec2 visit(ivec2 cell) {
    // Of the cells of a step, those with two even numbers were corners before.
    return ((cell.x | cell.y) & 1) == 0 ? ivec2(-1) : cell * (size.x >> (iteration + 1));
}

float kernel(ivec2 texel) {
    int reach = size.x >> (iteration + 1);
    bool on_lattice = ((texel.x | texel.y) & (reach - 1)) == 0;
    // From the middle to the ends of a diagonal; of an edge, which is its own other diagonal.
    // On a corner that was known before it is 0: the mean of four times itself is its height.
    ivec2 rising = on_lattice ? texel & reach : ivec2(0);
    ivec2 falling = ivec2(rising.x, -rising.y);
    float along = previous(texel - rising) + previous(texel + rising);
    float across = previous(texel - falling) + previous(texel + falling);
    float mean = (along + across) * 0.25;
    float amplitude = 1.0;
    for (int k = 0; k < iteration; k++) amplitude *= roughness;
    bool is_new = rising.x + rising.y > 0;
    ivec2 point = finest_point(texel, size.x - 1);
    return is_new ? mean + random_signed(point, seed + SALT) * amplitude : mean;
}
