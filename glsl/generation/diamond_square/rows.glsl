// generation/diamond_square/rows.glsl -- rows of a lattice from rows of the next coarser one.
//
//   gives    Lattice, new_height, edge_in_column, four_centres, five_centres, six_of_even_row,
//            six_of_odd_row, eight_of_even_row, eight_of_odd_row
//   needs    generation/diamond_square/lattice.glsl, noise/hash.glsl
//   units    heights without unit; columns and rows in spacings of the lattice they belong to
//   source   Belaiche 2010, sections 1.3.2 and 4.3.1
//   tested   tests/glsl/test_halving.py: the variant that uses them, against
//            generation/diamond_square/raw.glsl, bit for bit
//
// A lattice's points with even columns and rows are those of the coarser lattice; centres have
// both odd, edges one of them. Five columns of a lattice are enough for two finer ones:
//
//   columns 2 j - 1 .. 2 j + 3   and the 4 centres between them give
//   columns 4 j - 1 .. 4 j + 4   of the finer lattice; these and the 5 centres between them
//   columns 8 j .. 8 j + 7       of the finest
//
// Of these, columns 4 j and 8 j may be the first or the last of their lattice, column 4 j + 4
// the last; what lies further east is then no height, and no height depends on it.
//
// Neighbours are added one by one, from the east or north-east counter-clockwise, as raw.glsl
// does: sums are the same to the last bit.
#ifndef GENERATION_DIAMOND_SQUARE_ROWS
#define GENERATION_DIAMOND_SQUARE_ROWS
#include "generation/diamond_square/lattice.glsl"
#include "noise/hash.glsl"

struct Lattice {
    int side;         // spacings
    int halvings;     // from it to the finest lattice, see noise/finest.glsl
    float amplitude;  // how far a random number of 1 moves a new height
    bool centred;     // random numbers in [-1, 1), not in [0, 1)
    uint seed;        // the salt added
};

// The height of a new point between four neighbours, or three of them at the border.
// anchor: height
float new_height(vec4 neighbours, bvec4 inside, ivec2 point, Lattice lattice) {
    ivec2 key = point << lattice.halvings;
    float number = lattice.centred ? random_signed(key, lattice.seed) : random(key, lattice.seed);
    // In a loop: Mesa makes a sum of sums out of a + b + c + d.
    float total = 0.0;
    for (int i = 0; i < 4; i++) total += inside[i] ? neighbours[i] : 0.0;
    return total / (all(inside) ? 4.0 : 3.0) + number * lattice.amplitude;
}
// end: height

// The centre of a cell, from its corners in the north-east, north-west, south-west, south-east.
float centre(vec4 corners, ivec2 cell, Lattice lattice) {
    return new_height(corners, bvec4(true), 2 * cell + 1, lattice);
}

// A point of an even row, from its neighbours in the east, north, west and south: those in its
// row are always there.
float edge_in_row(vec4 neighbours, ivec2 point, Lattice lattice) {
    bvec4 inside = bvec4(true, point.y < lattice.side, true, point.y > 0);
    return new_height(neighbours, inside, point, lattice);
}

// A point of an odd row: those in its column are always there. Only some columns can be the first
// or the last; so the others are spared the question.
float edge_in_column(vec4 neighbours, ivec2 point, bvec2 ends, Lattice lattice) {
    bvec4 inside = bvec4(!ends.y || point.x < lattice.side, true, !ends.x || point.x > 0, true);
    return new_height(neighbours, inside, point, lattice);
}

// Centres between columns 2 j - 1 .. 2 j + 3 of the coarser rows `row` and `row + 1`.
void four_centres(float low[5], float high[5], int j, int row,
                  Lattice lattice, out float centres[4]) {
    for (int i = 0; i < 4; i++) {
        vec4 corners = vec4(high[i + 1], high[i], low[i], low[i + 1]);
        centres[i] = centre(corners, ivec2(2 * j - 1 + i, row), lattice);
    }
}

// Columns 4 j - 1 .. 4 j + 4 of an even row: the coarser row, and the centres south and north
// of it.
void six_of_even_row(float known[5], float below[4], float above[4], int j, int row,
                     Lattice lattice, out float found[6]) {
    for (int i = 0; i < 3; i++) {
        vec4 neighbours = vec4(known[i + 1], above[i], known[i], below[i]);
        found[2 * i] = edge_in_row(neighbours, ivec2(4 * j + 2 * i - 1, row), lattice);
        found[2 * i + 1] = known[i + 1];
    }
}

// The same columns of an odd row: the coarser rows south and north of it, and the centres in it.
void six_of_odd_row(float low[5], float high[5], float centres[4], int j, int row,
                    Lattice lattice, out float found[6]) {
    for (int i = 0; i < 3; i++) {
        vec4 neighbours = vec4(centres[i + 1], high[i + 1], centres[i], low[i + 1]);
        ivec2 point = ivec2(4 * j + 2 * i, row);
        found[2 * i] = centres[i];
        found[2 * i + 1] = edge_in_column(neighbours, point, bvec2(i == 0, i != 1), lattice);
    }
}

// Centres between columns 4 j - 1 .. 4 j + 4 of the coarser rows `row` and `row + 1`.
void five_centres(float low[6], float high[6], int j, int row,
                  Lattice lattice, out float centres[5]) {
    for (int i = 0; i < 5; i++) {
        vec4 corners = vec4(high[i + 1], high[i], low[i], low[i + 1]);
        centres[i] = centre(corners, ivec2(4 * j - 1 + i, row), lattice);
    }
}

// Columns 8 j .. 8 j + 7 of an even row.
void eight_of_even_row(float known[6], float below[5], float above[5], int j, int row,
                       Lattice lattice, out vec4 found[2]) {
    for (int i = 0; i < 4; i++) {
        vec4 neighbours = vec4(known[i + 2], above[i + 1], known[i + 1], below[i + 1]);
        float edge = edge_in_row(neighbours, ivec2(8 * j + 2 * i + 1, row), lattice);
        found[i >> 1][2 * (i & 1)] = known[i + 1];
        found[i >> 1][2 * (i & 1) + 1] = edge;
    }
}

// The same columns of an odd row.
void eight_of_odd_row(float low[6], float high[6], float centres[5], int j, int row,
                      Lattice lattice, out vec4 found[2]) {
    for (int i = 0; i < 4; i++) {
        vec4 neighbours = vec4(centres[i + 1], high[i + 1], centres[i], low[i + 1]);
        ivec2 point = ivec2(8 * j + 2 * i, row);
        float edge = edge_in_column(neighbours, point, bvec2(i == 0), lattice);
        found[i >> 1][2 * (i & 1)] = edge;
        found[i >> 1][2 * (i & 1) + 1] = centres[i + 1];
    }
}
#endif
