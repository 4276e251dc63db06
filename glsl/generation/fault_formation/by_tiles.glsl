// generation/fault_formation/by_tiles.glsl -- the sum of faults, of which a texel asks only those that cross its tile.
//
//   gives    height, as generation/fault_formation/sum.glsl
//   needs    generation/fault_formation/line.glsl, maths/bits.glsl, maths/whole.glsl
//   units    heights without unit
//   source   made here
//   tested   tests/glsl/test_fault_formation.py, against a twin in NumPy
//
// Of each block of 96 faults, those that do not cross the texel's tile are taken together, as
// generation/fault_formation/tiles.glsl has added them up; of the others there is a bit each.
#include "generation/fault_formation/line.glsl"
#include "maths/bits.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D lines;     //! input
uniform sampler2D crossing;  //! input
uniform sampler2D still;     //! input
uniform int faults = 200;    //! slider(0, 1000) How many
uniform float amount = 0.05; //! log_slider(0.001, 1) Height of the first fault, at most

int change_by(int which, ivec2 place) {
    vec4 fault = texelFetch(lines, ivec2(which, 0), 0);
    return is_raised(ivec3(fault.xyz), place) ? int(fault.w) : -int(fault.w);
}

float kernel(ivec2 texel) {
    ivec2 place = ivec2(place_of_texel(texel.x, size.x), place_of_texel(texel.y, size.y));
    int blocks = max(quotient(faults + 95, 96), 1);
    ivec2 tiles = textureSize(crossing, 0);
    tiles.x = max(quotient(tiles.x, blocks), 1);
    ivec2 tile = min((place * tiles) >> 15, tiles - 1);
    int change = 0;
    for (int block = 0; block < blocks; block++) {
        int first = block * 96;
        ivec2 at = ivec2(block * tiles.x + tile.x, tile.y);
        uvec4 marks = uvec4(texelFetch(crossing, at, 0));
        change += int(texelFetch(still, at, 0).r);
        uint bits = marks.x;
        marks = uvec4(marks.yzw, 0u);
        // One loop for the four channels: four loops cost a third more.
        while ((bits | marks.x | marks.y | marks.z) != 0u) {
            if (bits == 0u) {
                bits = marks.x;
                marks = uvec4(marks.yzw, 0u);
                first += 24;
            }
            if (bits != 0u) change += change_by(first + lowest_bit(bits), place);
            bits &= bits - 1u;
        }
    }
    return float(change) * fault_unit(faults, amount);
}
