// generation/fault_formation/tiles.glsl -- which faults cross a tile, and the sum of others.
//
//   gives    crossing: 96 marks, see generation/marks.glsl; still: the height, in units, that
//            those faults add that do not cross
//   needs    generation/fault_formation/line.glsl, generation/marks.glsl, maths/whole.glsl
//   units    see generation/fault_formation/line.glsl
//   source   made here
//   tested   tests/glsl/test_marks.py, as part of the fast variant
#include "generation/fault_formation/line.glsl"
#include "generation/marks.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "crossing:rgba32f, still:r32f")

uniform sampler2D lines;   //! input
uniform int faults = 200;  //! slider(0, 1000) As in the technique

// The south-western corner of a tile.
ivec2 corner_of(ivec2 tile, ivec2 tiles) {
    ivec2 part = tile * PLACES;
    return ivec2(quotient(part.x, tiles.x), quotient(part.y, tiles.y));
}

void kernel(ivec2 texel, out vec4 crossing, out float still) {
    int known = min(faults, textureSize(lines, 0).x);
    ivec3 grid = tile_grid(size, faults);
    int block = quotient(texel.x, grid.x);
    ivec2 tile = ivec2(texel.x - block * grid.x, texel.y);
    ivec2 low = corner_of(tile, grid.xy);
    ivec2 high = corner_of(tile + 1, grid.xy);
    int total = 0;
    for (int channel = 0; channel < 4; channel++) {
        int bits = 0;
        for (int i = 0; i < MARKS_A_CHANNEL; i++) {
            int which = block * MARKS + channel * MARKS_A_CHANNEL + i;
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
