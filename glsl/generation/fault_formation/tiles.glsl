// generation/fault_formation/tiles.glsl -- which faults cross a tile of the land, and what all others do to it.
//
//   gives    crossing: a bit for each of 96 faults, 24 in a channel; still: the height, in
//            units, that those add that do not cross
//   needs    generation/fault_formation/line.glsl, maths/whole.glsl
//   units    see generation/fault_formation/line.glsl
//   source   made here
//   tested   tests/glsl/test_fault_formation.py: the land is the one without tiles
//
// A row holds a whole row of tiles for the first 96 faults, then one for the next 96, and so on.
#include "generation/fault_formation/line.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "crossing:rgba32f, still:r32f")

uniform sampler2D lines;   //! input
uniform int faults = 200;  //! slider(0, 1000) How many

void kernel(ivec2 texel, out vec4 crossing, out float still) {
    int known = min(faults, textureSize(lines, 0).x);
    int blocks = max(quotient(faults + 95, 96), 1);
    ivec2 tiles = ivec2(max(quotient(size.x, blocks), 1), size.y);
    int part = quotient(texel.x, tiles.x);
    ivec2 tile = ivec2(texel.x - part * tiles.x, texel.y);
    ivec2 low = ivec2(quotient(tile.x * LAND_SIDE, tiles.x), quotient(tile.y * LAND_SIDE, tiles.y));
    ivec2 high = ivec2(quotient((tile.x + 1) * LAND_SIDE, tiles.x), quotient((tile.y + 1) * LAND_SIDE, tiles.y));
    int total = 0;
    for (int channel = 0; channel < 4; channel++) {
        int bits = 0;
        for (int i = 0; i < 24; i++) {
            int which = part * 96 + channel * 24 + i;
            if (which >= known) break;
            vec4 fault = texelFetch(lines, ivec2(which, 0), 0);
            ivec3 line = ivec3(fault.xyz);
            // The tile's corners furthest to the left and to the right of the line.
            ivec2 left = ivec2(line.x > 0 ? high.x : low.x, line.y > 0 ? high.y : low.y);
            bool some = is_raised(line, left);
            bool all_of_it = is_raised(line, low + high - left);
            if (some != all_of_it) bits |= 1 << i;
            else total += some ? int(fault.w) : -int(fault.w);
        }
        crossing[channel] = float(bits);
    }
    still = float(total);
}
