// generation/diamond_square/raw.glsl -- terrain by halving a square: its centres, then its edges.
//
//   gives    height, for any terrain of 2^n + 1 texels a side
//   needs    noise/finest.glsl, noise/hash.glsl, generation/diamond_square/lattice.glsl
//   units    heights without unit; not normalised, so that smoothing means something
//   source   Belaiche 2010, sections 1.3.2 and 4.3.1, after Fournier, Fussell and
//            Carpenter 1982 (Communications of the ACM 25, 6)
//   tested   tests/glsl/test_halving.py, against a float64 twin with the same hash
//
// Step 0 sets the four corners. Then each spacing s = side, side/2, .. 2 has two steps:
//
//     centres   (odd steps)   neighbours s/2 diagonally away
//     edges     (even steps)  neighbours s/2 along the axes; at the border three of four exist
//
// and each new height is
//
//     h = mean(neighbours) + random * (s / side) * smoothing
//
// The thesis halves the spacing before the formula in section 1.3.2 and after it in 4.3.1;
// this uses the full spacing, over the side, so that a terrain looks alike at every size.
// The thesis calls the centres' step "square" in one section and "diamond" in the other:
// here they are centres and edges.
#include "generation/diamond_square/lattice.glsl"
#include "noise/finest.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f", accepts = "2**n + 1", \
               repeat = "2 * log2(size.x - 1) + 1", \
               where = "spacings = 2**((iteration + 1) // 2)", \
               visits = "spacings + 1, spacings + 1", \
               stride = "(size.x - 1) // spacings", between = "squares")

uniform float smoothing = 0.2;  //! slider(0, 1) step(0.01) Roughness: height added per side of the
                                //! terrain. Above 0.5 it looks like rubble
uniform uint seed = 7u;         //! slider(0, 9999) Which terrain
uniform int sign_of_random = 0; //! menu("centred", "positive") label("Random") The thesis adds
                                //! only positive numbers, which leaves creases
uniform vec4 corners = vec4(0.5, 0.5, 0.5, 0.5);  //! slider(0, 1) step(0.01)
    //! parts("SW", "SE", "NW", "NE")
    //! Heights of the corners: south-west, south-east, north-west, north-east

float corner(ivec2 texel);

float kernel(ivec2 texel) {
    int side = size.x - 1;
    if (!is_set_by(texel, iteration, side)) return previous(texel);
    if (iteration == 0) return corner(texel);
    // anchor: neighbours
    // The four neighbours lie along the diagonals of a centre, along the axes of an edge.
    int r = half_spacing(iteration, side);
    ivec2 along = (iteration & 1) == 1 ? ivec2(r, r) : ivec2(r, 0);
    ivec2 across = ivec2(-along.y, along.x);
    ivec2 neighbours[4] = ivec2[4](texel + along, texel + across, texel - along, texel - across);
    // end: neighbours
    // anchor: height
    float total = 0.0;
    float count = 0.0;
    for (int i = 0; i < 4; i++) {
        bool inside = neighbours[i] == clamp(neighbours[i], ivec2(0), ivec2(side));
        total += inside ? previous(neighbours[i]) : 0.0;
        count += inside ? 1.0 : 0.0;
    }
    float share = float(2 * r) / float(side);
    ivec2 point = finest_point(texel, side);
    uint which = seed + DIAMOND_SQUARE_SALT;
    float number = sign_of_random == 0 ? random_signed(point, which) : random(point, which);
    return total / count + number * pow(share, 0.8) * smoothing;
    // end: height
}

float corner(ivec2 texel) {
    bool east = texel.x > 0;
    bool north = texel.y > 0;
    return north ? (east ? corners.w : corners.z) : (east ? corners.y : corners.x);
}

// Of the lattice's points, those that this step sets.
ivec2 visit(ivec2 cell) {
    ivec2 texel = cell * half_spacing(iteration, size.x - 1);
    return is_set_by(texel, iteration, size.x - 1) ? texel : ivec2(-1);
}
