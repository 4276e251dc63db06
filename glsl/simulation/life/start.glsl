// simulation/life/start.glsl -- the first generation: a soup, or a known pattern.
//
//   gives    life, 1 for a living cell and 0 for a dead one
//   needs    noise/hash.glsl
//   units    a texel is a cell
//   source   the patterns are those of Gardner 1970, "Mathematical Games", Scientific
//            American 223(4): the glider, and the R-pentomino
//   tested   tests/glsl/test_life.py, by how they move
#include "noise/hash.glsl"
#pragma kernel(output = "life:r8")

uniform int pattern = 0;       //! menu("soup", "gliders", "R-pentomino") The first generation
uniform float density = 0.35;  //! slider(0, 1) step(0.01) The share of living cells in the soup
uniform uint seed = 1u;        //! slider(0, 9999) Which soup

const uint SALT = 0xcd11f465u;  // CRC-32 of "simulation/life/start"
const int TILE = 16;                 // cells from one glider to the next
// Three rows of three cells each, the southern one first, the western cell in the highest bit.
const ivec3 GLIDER = ivec3(7, 1, 2);       // flies south-east
const ivec3 PENTOMINO = ivec3(2, 6, 3);

// The cell of a pattern whose south-western cell is (0, 0).
float cell_of(ivec3 rows, ivec2 cell) {
    if (any(lessThan(cell, ivec2(0))) || any(greaterThan(cell, ivec2(2)))) return 0.0;
    return float((rows[cell.y] >> (2 - cell.x)) & 1);
}

float kernel(ivec2 texel) {
    if (pattern == 0) return random(texel, seed + SALT) < density ? 1.0 : 0.0;
    if (pattern == 2) return cell_of(PENTOMINO, texel - size / 2 + 1);
    // A tile that the edge would cut stays empty.
    ivec2 tile = texel / TILE;
    if (any(greaterThan((tile + 1) * TILE, size))) return 0.0;
    return cell_of(GLIDER, texel - tile * TILE - TILE / 2 + 1);
}
