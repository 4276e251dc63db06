// generation/normalise.comp -- heights brought to 0..1 where they lie, four at a time.
//
//   gives    height
//   needs    generation/normalise/stretch.glsl, terrain/{extremes,order}.glsl, maths/whole.glsl
//   units    as the technique
//   source   as the technique
//   tested   tests/glsl/test_normalise.py, against NumPy, and tests/glsl/test_fast_variants.py
//   agrees   but for how a division is rounded
//
// A processor reads texels one by one, and fours of floats in a buffer several times quicker.
// `heights` begins as the terrain and ends as what it is stretched to: the first stage finds its
// range, the second stretches it. A terrain of another size than this pass is read texel
// by texel, all of it for the range.
#include "generation/normalise/stretch.glsl"
#include "maths/whole.glsl"
#include "terrain/extremes.glsl"
#include "terrain/order.glsl"
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

vec4 texels_of_four(int four) {
    vec4 found;
    for (int k = 0; k < 4; k++) {
        int y = quotient(4 * four + k, size.x);
        found[k] = texelFetch(height, ivec2(4 * four + k - y * size.x, y), 0).r;
    }
    return found;
}

void widen(vec4 h, inout vec4 least, inout vec4 most) {
    // As in `widened`: what is no number is neither.
    least = mix(least, h, lessThan(h, least));
    most = mix(most, h, greaterThan(h, most));
}

// What one reader finds, each READERS-th four of so many for a group.
vec2 range_of_fours(int first, int last) {
    vec4 least = vec4(NO_RANGE.x);
    vec4 most = vec4(NO_RANGE.y);
    for (int four = first; four < last; four += READERS) widen(heights[four], least, most);
    vec2 range = vec2(min(min(least.x, least.y), min(least.z, least.w)),
                      max(max(most.x, most.y), max(most.z, most.w)));
    return range;
}

void find() {
    int all_texels = size.x * size.y;
    int begin = int(gl_WorkGroupID.x) * 4096;
    int mine = int(gl_LocalInvocationIndex);
    vec2 range = NO_RANGE;
    if (matches_height) {
        range = range_of_fours(begin + mine, min(begin + 4096, all_texels >> 2));
        // The texels that fill no four.
        int single = (all_texels & ~3) + mine;
        if (begin == 0 && single < all_texels) {
            range = widened(range, vec2(heights[single >> 2][single & 3]));
        }
    } else {
        ivec2 land = textureSize(height, 0);
        for (int y = int(gl_GlobalInvocationID.x); y < land.y; y += READERS * int(gl_NumWorkGroups.x)) {
            for (int x = 0; x < land.x; x++) {
                range = widened(range, vec2(texelFetch(height, ivec2(x, y), 0).r));
            }
        }
    }
    uint highest = key_of_height(range.y);
    uint lowest = ~key_of_height(range.x);
    // Most readers have nothing to change, and see that sooner than an atomic tells them.
    if (highest > bounds[0]) atomicMax(bounds[0], highest);
    if (lowest > bounds[1]) atomicMax(bounds[1], lowest);
}

void stretch() {
    vec2 range = vec2(height_of_key(~bounds[1]), height_of_key(bounds[0]));
    vec2 by = stretch_of(range, mode);
    int begin = int(gl_WorkGroupID.x) * 1024;
    int last = min(begin + 1024, (size.x * size.y + 3) >> 2);
    for (int four = begin + int(gl_LocalInvocationIndex); four < last; four += READERS) {
        vec4 h = matches_height ? heights[four] : texels_of_four(four);
        heights[four] = stretched(h, by, mode);
    }
}

void main() {
    if (stage == FIND && mode != 0) find();
    if (stage == STRETCH) stretch();
}
