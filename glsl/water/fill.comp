// water/fill.comp -- depressions filled, tile by tile, until nothing changes.
//
//   gives    level, as water/fill.toml
//   needs    water/fill/tile.glsl, water/least_fall.glsl, water/texels.glsl
//   units    heights without unit
//   source   Planchon and Darboux 2002, "A fast, simple and versatile algorithm to fill the
//            depressions of digital elevation models", Catena 46; sweeps in turned directions:
//            Zhao 2005, "A fast sweeping method for eikonal equations"; the lists made here
//   tested   tests/glsl/test_fill.py, against a priority flood and the flood's own steps, bit by
//            bit; tests/glsl/test_fast_variants.py, against the passes
//   agrees   but for rounding: the passes begin with ways that are rounded once a doubling
//
// The flood only falls, and from any level above its end no step takes it below that: so the order
// in which texels fall makes no difference to the bits. Here a tile falls by a sweep each to the
// north, south, east and west, and calls those that touch what fell, itself too, into the list of
// the next step. So a step costs no more than what changes, and about four visits to each tile are
// enough. Where a neighbour's texels change meanwhile, either of their values will do: it calls.
//
// A level is final one step after the level that it follows from, at most; a way out has no more
// texels than the terrain. So that many steps are always enough, whatever the valleys' shape, and
// the run ends with the first step that calls no tile. The last step writes the levels.
#include "water/fill/tile.glsl"
#include "water/least_fall.glsl"
#include "water/texels.glsl"
#pragma compute(where = "columns = (size.x + 7) // 8; rows = (size.y + 7) // 8; \
                         tiles = columns * rows; \
                         fours = (2 * columns + 2) * (8 * rows + 2)", \
                groups = "(tiles + 1023) // 1024, 1", \
                local = "64, 1", repeat = "size.x * size.y + 2", active = "called", \
                buffers = "ground:vec4:fours; water:vec4:fours; wet:uint:2 * tiles; \
                           list:uint:2 * tiles; called:uint:3", \
                overwrites = "level, ground, water, list", agrees = "1e-5")

uniform sampler2D height;  //! input

const float NO_WAY = 1e30;  // the level where no way out is known, and outside

ivec2 tiles() { return (size + TILE - 1) / TILE; }

ivec2 tile_of(int number) {
    int row = quotient(number, tiles().x);
    return ivec2(number - row * tiles().x, row);
}

// Where four texels of a tile's row are, in fours: one more lies at each end of the rows, and one
// row below and above them all.
int fours_at(ivec2 tile, int row) {
    return (TILE * tile.y + row + 1) * (2 * tiles().x + 2) + 2 * tile.x + 1;
}

// Levels before the first step: water is let out at the edges only.
float begun(ivec2 texel, float bed) {
    return inside(texel, size) && on_edge(texel, size) ? bed : NO_WAY;
}

// Puts a tile into a step's list, unless it is there already.
void call(int number, int step_of_it) {
    int half_of = (step_of_it & 1) * tiles().x * tiles().y;
    if (atomicExchange(wet[half_of + number], 1u) != 0u) return;
    list[half_of + int(atomicAdd(called[step_of_it % 3], 1u))] = uint(number);
}

void begin_four(ivec2 corner, int place) {
    vec4 bed = vec4(NO_WAY);
    vec4 level = vec4(NO_WAY);
    for (int k = 0; k < 4; k++) {
        ivec2 texel = corner + ivec2(k, 0);
        if (inside(texel, size)) bed[k] = texelFetch(height, texel, 0).r;
        level[k] = begun(texel, bed[k]);
    }
    ground[place] = bed;
    water[place] = level;
}

// All fours of a tile, and the ones outside that it touches.
void begin(ivec2 tile, int number) {
    ivec2 low = ivec2(equal(tile, ivec2(0)));
    ivec2 high = ivec2(equal(tile, tiles() - 1));
    for (int y = -low.y; y < TILE + high.y; y++) {
        for (int part = -low.x; part < 2 + high.x; part++) {
            begin_four(TILE * tile + ivec2(4 * part, y), fours_at(tile, y) + part);
        }
    }
    if (on_edge(tile, tiles())) call(number, 1);
}

#define WEST(Y) water[fours_at(tile, Y) - 1].w
#define EAST(Y) water[fours_at(tile, Y) + 2].x
#define READ(Y) \
    bed[Y] = Line(ground[fours_at(tile, Y)], ground[fours_at(tile, Y) + 1]); \
    before[Y] = Line(water[fours_at(tile, Y)], water[fours_at(tile, Y) + 1]);
#define WRITE(Y) \
    water[fours_at(tile, Y)] = now[Y].low; \
    water[fours_at(tile, Y) + 1] = now[Y].high; \
    seen |= seen_from(Y, notEqual(now[Y].low, before[Y].low), \
                      notEqual(now[Y].high, before[Y].high));

// Which of the tiles around see texels of a row that fell.
uint seen_from(int y, bvec4 low, bvec4 high) {
    uint row = uint(any(low) || any(high)) << 1 | uint(low.x) | uint(high.w) << 2;
    return row << 3 | (y == 0 ? row : 0u) | (y == TILE - 1 ? row << 6 : 0u);
}

// Sweeps a tile; returns which of the nine tiles around it see something that fell, row by row.
uint fall(ivec2 tile) {
    Line bed[TILE];
    Line before[TILE];
    EIGHT(READ)
    int below = fours_at(tile, -1), above = fours_at(tile, TILE);
    Rim rim;
    rim.south = Line(water[below], water[below + 1]);
    rim.north = Line(water[above], water[above + 1]);
    rim.corners = vec4(water[below - 1].w, water[below + 2].x,
                       water[above - 1].w, water[above + 2].x);
    rim.west = Line(vec4(WEST(0), WEST(1), WEST(2), WEST(3)),
                    vec4(WEST(4), WEST(5), WEST(6), WEST(7)));
    rim.east = Line(vec4(EAST(0), EAST(1), EAST(2), EAST(3)),
                    vec4(EAST(4), EAST(5), EAST(6), EAST(7)));
    Line now[TILE] = swept(before, bed, rim, falls_between(spacing, relief));
    uint seen = 0u;
    EIGHT(WRITE)
    return seen;
}

void write_levels(ivec2 tile) {
    for (int y = 0; y < TILE; y++) {
        for (int x = 0; x < TILE; x++) {
            ivec2 texel = TILE * tile + ivec2(x, y);
            float level = water[fours_at(tile, y) + x / 4][x % 4];
            if (inside(texel, size)) imageStore(out_level, texel, vec4(level, 0.0, 0.0, 1.0));
        }
    }
}

void main() {
    int own = int(gl_GlobalInvocationID.x);
    int threads = 64 * int(gl_NumWorkGroups.x);
    int count = tiles().x * tiles().y;
    if (iteration == 0) {
        for (int k = own; k < count; k += threads) begin(tile_of(k), k);
        return;
    }
    if (iteration == iterations - 1) {
        for (int k = own; k < count; k += threads) write_levels(tile_of(k));
        return;
    }
    int half_of = (iteration & 1) * count;
    int end = int(called[iteration % 3]);
    if (own == 0) called[(iteration + 2) % 3] = 0u;  // read in the step before
    for (int here = own; here < end; here += threads) {
        int number = int(list[half_of + here]);
        wet[half_of + number] = 0u;
        ivec2 tile = tile_of(number);
        uint seen = fall(tile);
        for (int k = 0; k < 9; k++) {
            ivec2 other = tile + ivec2(k % 3, k / 3) - 1;
            if ((seen >> uint(k) & 1u) == 0u || !inside(other, tiles())) continue;
            call(other.y * tiles().x + other.x, iteration + 1);
        }
    }
}
