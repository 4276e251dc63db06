// water/fill/tile.glsl -- a tile of eight by eight texels, in which a flood falls.
//
//   gives    TILE, Line, Rim, swept
//   needs    nothing: pure functions, no uniforms, no textures
//   units    heights without unit
//   source   Zhao 2005, "A fast sweeping method for eikonal equations", Mathematics of
//            Computation 74; the levels are those of Planchon and Darboux 2002
//   tested   tests/glsl/test_fill.py
//
// In a sweep north each row falls to what the row south of it lets out, which has fallen itself
// by then: so water runs through the tile at once along any way that does not turn back.
#ifndef WATER_FILL_TILE
#define WATER_FILL_TILE

const int TILE = 8;

// Written out eight times: loops over arrays are slow where a driver does not unroll them.
#define EIGHT(DO) DO(0) DO(1) DO(2) DO(3) DO(4) DO(5) DO(6) DO(7)
#define EIGHT_BACK(DO) DO(7) DO(6) DO(5) DO(4) DO(3) DO(2) DO(1) DO(0)

// Eight texels in a row or in a column.
struct Line {
    vec4 low;
    vec4 high;
};

// What lies around a tile; the corners south-west, south-east, north-west, north-east.
struct Rim {
    Line south;
    Line north;
    Line west;
    Line east;
    vec4 corners;
};

float texel_in(Line line, int k) { return k < 4 ? line.low[k & 3] : line.high[k & 3]; }

// A line that falls to what its neighbour lets out; `ends` lie before and after that one.
Line fallen(Line line, Line ground, Line neighbour, vec2 ends, float straight, float diagonal) {
    vec4 low = min(vec4(ends.x, neighbour.low.xyz), vec4(neighbour.low.yzw, neighbour.high.x));
    vec4 high = min(vec4(neighbour.low.w, neighbour.high.xyz), vec4(neighbour.high.yzw, ends.y));
    low = max(ground.low, min(neighbour.low + straight, low + diagonal));
    high = max(ground.high, min(neighbour.high + straight, high + diagonal));
    return Line(min(line.low, low), min(line.high, high));
}

// Rows as columns.
Line[TILE] turned(Line rows[TILE]) {
    mat4 a = transpose(mat4(rows[0].low, rows[1].low, rows[2].low, rows[3].low));
    mat4 b = transpose(mat4(rows[0].high, rows[1].high, rows[2].high, rows[3].high));
    mat4 c = transpose(mat4(rows[4].low, rows[5].low, rows[6].low, rows[7].low));
    mat4 d = transpose(mat4(rows[4].high, rows[5].high, rows[6].high, rows[7].high));
    Line columns[TILE];
    columns[0] = Line(a[0], c[0]);
    columns[1] = Line(a[1], c[1]);
    columns[2] = Line(a[2], c[2]);
    columns[3] = Line(a[3], c[3]);
    columns[4] = Line(b[0], d[0]);
    columns[5] = Line(b[1], d[1]);
    columns[6] = Line(b[2], d[2]);
    columns[7] = Line(b[3], d[3]);
    return columns;
}

#define FALL(K) \
    lines[K] = fallen(lines[K], ground[K], neighbour, ends, straight, diagonal); \
    neighbour = lines[K]; \
    ends = vec2(texel_in(before, K), texel_in(after, K));

// A sweep up the lines and one down; `sides` are the texels before and after each line, `corners`
// those of the rim as its fields are named.
Line[TILE] swept_up_and_down(Line lines[TILE], Line ground[TILE], Line first, Line last,
                             Line before, Line after, vec4 corners, float straight,
                             float diagonal) {
    Line neighbour = first;
    vec2 ends = corners.xy;
    EIGHT(FALL)
    neighbour = last;
    ends = corners.zw;
    EIGHT_BACK(FALL)
    return lines;
}

// A tile's rows after a sweep each to the north, south, east and west. `falls` are those to a
// neighbour along x, along y and diagonally.
Line[TILE] swept(Line rows[TILE], Line ground[TILE], Rim rim, vec3 falls) {
    rows = swept_up_and_down(rows, ground, rim.south, rim.north, rim.west, rim.east,
                             rim.corners, falls.y, falls.z);
    return turned(swept_up_and_down(turned(rows), turned(ground), rim.west, rim.east, rim.south,
                                    rim.north, rim.corners.xzyw, falls.x, falls.z));
}
#endif
