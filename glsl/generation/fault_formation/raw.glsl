// generation/fault_formation/raw.glsl -- faults added to the land: one side of each line up, the other down.
//
//   gives    height, for any land; not normalised, half of it below 0
//   needs    generation/fault_formation/line.glsl, maths/bits.glsl, maths/whole.glsl
//   units    heights without unit
//   source   Belaiche 2010, section 1.3.6
//   tested   tests/glsl/test_fault_formation.py, against a twin in NumPy
//
// A turn is a fault; one run takes as many as are asked for. Sums are exact, so the order of
// faults is free: where a run takes all of a block of 96, those that do not cross the texel's
// tile are taken together, as generation/fault_formation/tiles.glsl has added them up.
#include "generation/fault_formation/line.glsl"
#include "maths/bits.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "height:r32f", repeat = "faults", at_once = "faults")

uniform sampler2D lines;     //! input
uniform sampler2D crossing;  //! input
uniform sampler2D still;     //! input
uniform int faults = 200;    //! slider(0, 1000) How many
uniform float amount = 0.05; //! log_slider(0.001, 1) Height of the first fault, at most

// anchor: change
int change_by(int which, ivec2 place) {
    vec4 fault = texelFetch(lines, ivec2(which, 0), 0);
    return is_raised(ivec3(fault.xyz), place) ? int(fault.w) : -int(fault.w);
}
// end: change

float kernel(ivec2 texel) {
    ivec2 place = ivec2(place_of_texel(texel.x, size.x), place_of_texel(texel.y, size.y));
    int end = min(until, min(faults, textureSize(lines, 0).x));
    int blocks = max(quotient(faults + 95, 96), 1);
    ivec2 tiles = textureSize(crossing, 0);
    tiles.x = max(quotient(tiles.x, blocks), 1);
    ivec2 tile = min((place * tiles) >> 15, tiles - 1);
    int change = 0;
    for (int block = 0; block < blocks; block++) {
        int first = block * 96;
        ivec2 asked = ivec2(max(first, iteration), min(first + 96, end));
        // Part of a block is every fault of it one by one; a whole block, the tile's.
        bool whole = asked == ivec2(first, min(first + 96, faults));
        ivec2 at = ivec2(block * tiles.x + tile.x, tile.y);
        uvec4 marks = uvec4(texelFetch(crossing, at, 0));
        if (whole) change += int(texelFetch(still, at, 0).r);
        ivec4 from = clamp(asked.x - first - ivec4(0, 24, 48, 72), 0, 24);
        ivec4 to = clamp(asked.y - first - ivec4(0, 24, 48, 72), 0, 24);
        if (!whole) marks = (uvec4(1u) << uvec4(max(from, to))) - (uvec4(1u) << uvec4(from));
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
    float unit = fault_unit(faults, amount);
    // A land to begin with is rounded to the same units: so the order of turns stays free.
    return (floor(previous(texel) / unit + 0.5) + float(change)) * unit;
}
