// terrain/range/blocks.comp -- the range of heights in each block, by 64 readers.
//
//   gives    range: lowest in red, highest in green; a block of the terrain for each texel
//   needs    terrain/extremes.glsl, maths/whole.glsl
//   units    as the heights
//   source   a tree reduction in shared memory, as in M. Harris 2007, "Optimizing Parallel
//            Reduction in CUDA"
//   tested   tests/glsl/test_fast_variants.py, against terrain/range/blocks.glsl
//   agrees   exactly: the lowest of numbers is the same in any order
//
// The kernel next to it has one thread read a whole block. Here a work group shares the block:
// each reader takes every eighth texel of every eighth row, so that neighbours read
// neighbours, then pairs of readers are joined until one is left.
#include "maths/whole.glsl"
#include "terrain/extremes.glsl"
#pragma compute(groups = "size.x, size.y", local = "8, 8", agrees = "exact")

uniform sampler2D height; //! input
uniform int sought = 2;   //! menu("nothing", "highest", "lowest and highest")
                          //! With nothing, 0 and 1 are told without a look at the terrain

const int READERS = 64;
shared vec2 found[READERS];

void main() {
    ivec2 texel = ivec2(gl_WorkGroupID.xy);
    ivec2 reader = ivec2(gl_LocalInvocationID.xy);
    int mine = int(gl_LocalInvocationIndex);
    ivec2 land = textureSize(height, 0);
    ivec2 from = ivec2(quotient(texel.x * land.x, size.x), quotient(texel.y * land.y, size.y));
    ivec2 to = ivec2(quotient((texel.x + 1) * land.x, size.x),
                     quotient((texel.y + 1) * land.y, size.y));
    if (sought == 0) to = from;
    vec2 seen = NO_RANGE;
    for (int y = from.y + reader.y; y < to.y; y += 8) {
        for (int x = from.x + reader.x; x < to.x; x += 8) {
            seen = widened(seen, vec2(texelFetch(height, ivec2(x, y), 0).r));
        }
    }
    found[mine] = seen;
    barrier();
    for (int half_of = READERS / 2; half_of > 0; half_of /= 2) {
        if (mine < half_of) found[mine] = widened(found[mine], found[mine + half_of]);
        barrier();
    }
    if (mine == 0) {
        imageStore(out_range, texel, vec4(sought == 0 ? vec2(0.0, 1.0) : found[0], 0.0, 1.0));
    }
}
