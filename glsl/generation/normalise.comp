// generation/normalise.comp -- heights brought to 0..1 where they lie, four at a time.
//
//   gives    height
//   needs    generation/normalise/{stretch,tell}.glsl, maths/whole.glsl
//   units    as the technique
//   source   as the technique
//   tested   tests/glsl/test_filters.py, against NumPy, and tests/glsl/test_fast_variants.py
//   agrees   but for how a division is rounded
//
// A processor reads texels one by one, and fours of floats in a buffer several times quicker.
// `heights` begins as the terrain and ends as what it is stretched to: the first stage finds its
// range, the second stretches it. A terrain of another size than this pass is read texel
// by texel, all of it for the range.
#include "generation/normalise/stretch.glsl"
#include "generation/normalise/tell.glsl"
#include "maths/whole.glsl"
#pragma compute(stages = "0, 1", local = "64, 1", \
                where = "fours = (size.x * size.y + 3) // 4", \
                groups = "fours // (1024 if iteration else 4096) + 1, 1", \
                buffers = "heights:vec4:fours; bounds:uint:2", \
                in_place = "heights", overwrites = "height, heights", aligned = "4", \
                agrees = "1e-6")

uniform sampler2D height;  //! input
uniform int mode = 2;      //! menu("none", "max", "minmax") label("Normalise") As in the technique

const int FIND = 0, STRETCH = 1;
const int READERS = 64;
const int FOUND = 4096, STRETCHED = 1024;  // fours to a group

vec4 texels_of_four(int four) {
    vec4 found;
    for (int k = 0; k < 4; k++) {
        int y = quotient(4 * four + k, size.x);
        found[k] = texelFetch(height, ivec2(4 * four + k - y * size.x, y), 0).r;
    }
    return found;
}

// Each READERS-th four of FOUND fours for a group, and the texels that fill no four.
Told range_in_place(Told told) {
    int mine = int(gl_LocalInvocationIndex);
    int begin = int(gl_WorkGroupID.x) * FOUND;
    int all_texels = size.x * size.y;
    int last = min(begin + FOUND, all_texels >> 2);
    for (int four = begin + mine; four < last; four += READERS) {
        told = told_also(told, read_heights(four));
    }
    int single = (all_texels & ~3) + mine;
    if (begin == 0 && single < all_texels) {
        told = told_also(told, vec4(heights[single >> 2][single & 3]));
    }
    return told;
}

Told range_of_texels(Told told) {
    ivec2 land = textureSize(height, 0);
    int readers = READERS * int(gl_NumWorkGroups.x);
    for (int y = int(gl_GlobalInvocationID.x); y < land.y; y += readers) {
        for (int x = 0; x < land.x; x++) {
            told = told_also(told, vec4(texelFetch(height, ivec2(x, y), 0).r));
        }
    }
    return told;
}

void stretch() {
    vec2 by = told_stretch(mode);
    int begin = int(gl_WorkGroupID.x) * STRETCHED;
    int last = min(begin + STRETCHED, (size.x * size.y + 3) >> 2);
    for (int four = begin + int(gl_LocalInvocationIndex); four < last; four += READERS) {
        vec4 h = matches_height ? read_heights(four) : texels_of_four(four);
        heights[four] = stretched(h, by, mode);
    }
}

void main() {
    if (stage == FIND && mode != 0) {
        Told told = nothing_told();
        tell(matches_height ? range_in_place(told) : range_of_texels(told));
    }
    if (stage == STRETCH) stretch();
}
