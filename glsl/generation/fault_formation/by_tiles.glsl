// generation/fault_formation/by_tiles.glsl -- the sum of faults, of each tile those that cross it.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/fault_formation/line.glsl, generation/marks.glsl
//   units    heights without unit
//   source   the sum of generation/fault_formation/sum.glsl
//   tested   tests/glsl/test_marks.py, as part of the fast variant
#include "generation/fault_formation/line.glsl"
#include "generation/marks.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D lines;     //! input
uniform sampler2D crossing;  //! input
uniform sampler2D still;     //! input
uniform int faults = 200;    //! slider(0, 1000) As in the technique
uniform float amount = 0.05; //! log_slider(0.001, 1) As in the technique

float kernel(ivec2 texel) {
    ivec2 place = ivec2(place_of_texel(texel.x, size.x), place_of_texel(texel.y, size.y));
    ivec3 grid = tile_grid(textureSize(crossing, 0), faults);
    ivec2 tile = min((place * grid.xy) >> 15, grid.xy - 1);
    int change = 0;
    for (int block = 0; block < grid.z; block++) {
        ivec2 at = ivec2(block * grid.x + tile.x, tile.y);
        change += int(texelFetch(still, at, 0).r);
        Marks marks = marks_of(texelFetch(crossing, at, 0), block * MARKS);
        while (some_left(marks)) {
            int which = next_mark(marks);
            if (which >= 0) {
                vec4 fault = texelFetch(lines, ivec2(which, 0), 0);
                change += is_raised(ivec3(fault.xyz), place) ? int(fault.w) : -int(fault.w);
            }
        }
    }
    return float(change) * fault_unit(faults, amount);
}
