// generation/diamond_square/raw.glsl -- land by halving a square: its centres, then its edges, over and over.
//
//   gives    height, for any land of 2^n + 1 texels a side
//   needs    noise/hash.glsl
//   units    heights without unit; not normalised, so that smoothing means something
//   source   Belaiche 2010, sections 1.3.2 and 4.3.1, after Fournier, Fussell and
//            Carpenter 1982 (Communications of the ACM 25, 6)
//   tested   tests/glsl/test_diamond_square.py, against a float64 twin with the same hash
//
// Turn 0 sets the four corners. Then each spacing s = side, side/2, .. 2 has two turns:
//   centres   (odd turns)   every texel in the middle of four known ones, s/2 diagonally away
//   edges     (even turns)  every texel between known ones, s/2 along the axes; at the
//                           border three of the four exist, and those are averaged
// and each new height is   mean + random * (s / side) * smoothing.
//
// The thesis halves the spacing before the formula in section 1.3.2 and after it in 4.3.1;
// this uses the full spacing, over the side, so that a land looks alike at every size.
// The thesis calls the centres' turn "square" in one section and "diamond" in the other:
// here they are centres and edges.
#include "noise/hash.glsl"
#pragma kernel(output = "height:r32f", repeat = "2 * log2(size.x - 1) + 1", accepts = "2**n + 1", visits = "2 if iteration == 0 else 2**((iteration - 1) // 2) + 1 - iteration % 2, 2 if iteration == 0 else 2**(iteration // 2) + 1 - iteration % 2")

uniform float smoothing = 0.2;  //! slider(0, 1) step(0.01) Roughness: height added per side of land. Above 0.5 it looks like rubble
uniform uint seed = 7u;         //! slider(0, 9999) Which land
uniform int sign_of_random = 0; //! menu("centred", "positive") label("Random") The thesis adds only positive numbers, which leaves creases
uniform vec4 corners = vec4(0.5, 0.5, 0.5, 0.5);  //! slider(0, 1) step(0.01) Heights of the corners: south-west, south-east, north-west, north-east

// Half the spacing of a turn, in texels, a power of two: half the side for turns 1 and 2, a quarter for 3 and 4, ..
int half_spacing() {
    return (size.x - 1) >> ((iteration + 1) >> 1);
}

// The texel that a cell of this turn sets.
ivec2 visit(ivec2 cell) {
    if (iteration == 0) return cell * (size - 1);
    int r = half_spacing();
    if ((iteration & 1) == 1) return (2 * cell + 1) * r;
    // Along even rows of half spacings the edges are the odd places, along odd rows the even ones.
    int place = (cell.y & 1) == 0 ? 2 * cell.x + 1 : 2 * cell.x;
    return ivec2(place, cell.y) * r;
}

// The same the other way round. Masks, not division: a side is a power of two.
bool is_visited(ivec2 texel) {
    if (iteration == 0) return (texel.x == 0 || texel.x == size.x - 1) && (texel.y == 0 || texel.y == size.y - 1);
    int r = half_spacing();
    if (((texel.x | texel.y) & (r - 1)) != 0) return false;
    bool between_x = (texel.x & r) != 0;
    bool between_y = (texel.y & r) != 0;
    return (iteration & 1) == 1 ? between_x && between_y : between_x != between_y;
}

float corner(ivec2 texel) {
    bool east = texel.x > 0;
    bool north = texel.y > 0;
    return north ? (east ? corners.w : corners.z) : (east ? corners.y : corners.x);
}

float kernel(ivec2 texel) {
    if (!is_visited(texel)) return previous(texel);
    if (iteration == 0) return corner(texel);
    int r = half_spacing();
    // The four neighbours lie along the diagonals of a centre, along the axes of an edge.
    ivec2 along = (iteration & 1) == 1 ? ivec2(r, r) : ivec2(r, 0);
    ivec2 across = ivec2(-along.y, along.x);
    float total = 0.0;
    float count = 0.0;
    for (int i = 0; i < 4; i++) {
        ivec2 towards = (i & 1) == 0 ? along : across;
        ivec2 other = i < 2 ? texel + towards : texel - towards;
        bool inside = min(other.x, other.y) >= 0 && max(other.x, other.y) < size.x;
        total += inside ? previous(other) : 0.0;
        count += inside ? 1.0 : 0.0;
    }
    float share = float(2 * r) / float(size.x - 1);
    float number = sign_of_random == 0 ? random_signed(texel, seed) : random(texel, seed);
    return total / count + number * share * smoothing;
}
