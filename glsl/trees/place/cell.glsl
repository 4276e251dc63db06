// trees/place/cell.glsl -- the tree that a cell of the world may hold, by the cell's number alone.
//
//   gives    Rooted, tree_in
//   needs    noise/hash.glsl, trees/level.glsl
//   units    shares: of a cell's side from its middle; of 0..1
//   source   a cell is a whole number of the world, hashed, so where a tree stands depends neither
//            on the eye nor on the picture nor on the part of the terrain that is drawn
//   tested   tests/glsl/test_trees.py, tests/flight/test_woods.py
#ifndef TREES_PLACE_CELL
#define TREES_PLACE_CELL
#include "noise/hash.glsl"
#include "trees/level.glsl"

const uint PLACE_SALT = 0xc07a7689u;  // CRC-32 of "trees/place"

struct Rooted {
    vec2 off;      // from the cell's middle
    float chance;  // it is there where the density is above
    float rank;    // trees/level.glsl
    float size;    // from the shortest to the tallest
};

Rooted tree_in(ivec2 cell_of_world, uint seed_of_trees) {
    uvec2 at = uvec2(cell_of_world);
    uvec3 first = hash3(uvec3(at, seed_of_trees + PLACE_SALT));
    uvec3 second = hash3(uvec3(at, seed_of_trees + PLACE_SALT + 1u));
    vec2 jitter = vec2(unit_from_bits(first.x), unit_from_bits(first.y)) - 0.5;
    return Rooted(JITTER * jitter, unit_from_bits(first.z), unit_from_bits(second.x),
                  unit_from_bits(second.y));
}
#endif
