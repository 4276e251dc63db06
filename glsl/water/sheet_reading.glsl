// water/sheet_reading.glsl -- the water over a place of the terrain.
//
//   gives    Sheet, sheet_at, OPEN, is_open
//   needs    nothing; the texture, by water/sea or water/sheet, comes as an argument
//   units    metres over height 0; metres a second; shares 0..1
//   source   none: the order of channels
//   tested   tests/glsl/test_water_sheet.py
//
// One texture says all of standing and running water: r, the height of its surface, which goes on
// beyond the shore so that the line between wet and dry runs between texels; g and b, its current
// east and north; a, how white it runs, 0..1, or OPEN where it is the sea, which has no end at the
// terrain's edges. A place is wet where the surface is over the ground.
#ifndef WATER_SHEET_READING
#define WATER_SHEET_READING

const float OPEN = -1.0;

struct Sheet {
    float level;   // of the surface [m]
    vec2 current;  // [m/s]
    float white;   // or OPEN
};

bool is_open(Sheet sheet) { return sheet.white < -0.5; }

// At a share of the terrain's sides; beyond its edges, as on them.
Sheet sheet_at(sampler2D water, vec2 share) {
    ivec2 last = textureSize(water, 0) - 1;
    vec2 clamped = clamp(share, 0.0, 1.0) * vec2(last);
    ivec2 low = ivec2(clamped);
    ivec2 high = min(low + 1, last);
    vec2 part = clamped - vec2(low);
    vec4 south_west = texelFetch(water, low, 0);
    vec4 north_west = texelFetch(water, ivec2(low.x, high.y), 0);
    // Between equal levels it is exactly that level: a + (b - a) t.
    vec4 west = south_west + (north_west - south_west) * part.y;
    vec4 south_east = texelFetch(water, ivec2(high.x, low.y), 0);
    vec4 north_east = texelFetch(water, high, 0);
    vec4 east = south_east + (north_east - south_east) * part.y;
    vec4 found = west + (east - west) * part.x;
    return Sheet(found.r, found.gb, found.a);
}
#endif
