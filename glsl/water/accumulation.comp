// water/accumulation.comp -- drained areas, each texel visited once.
//
//   gives    area, as water/accumulation.toml
//   needs    water/texels.glsl
//   units    m^2
//   source   topological order, after Braun and Willett 2013, "A very efficient O(n), implicit and
//            parallel method to solve the stream power equation", Geomorphology 180-181; the
//            donors counted by atomics, made here
//   tested   tests/glsl/test_accumulation.py, against serial counting, and
//            tests/glsl/test_fast_variants.py, against the passes
//   agrees   exactly: cells are whole numbers
//
// A thread follows the water from each spring. It adds what it brings to the next texel and
// leaves, unless it is the last of the texel's donors to arrive: then the texel's sum is known,
// and it goes on with that. No thread waits for another.
#include "water/texels.glsl"
#pragma compute(where = "cells = size.x * size.y", \
                groups = "(size.x + 7) // 8, (size.y + 7) // 8", local = "8, 8", \
                stages = "0, 1, 2", buffers = "brought:uint:cells; donors:uint:cells", \
                overwrites = "area", agrees = "exact")

uniform sampler2D receiver;  //! input

// A neighbour, or the texel itself where no neighbour's number is given.
int down_from(int from) {
    ivec2 texel = texel_of(float(from), size);
    float to = texelFetch(receiver, texel, 0).r;
    ivec2 there = texel_of(to, size);
    bool adjacent = all(lessThanEqual(abs(there - texel), ivec2(1)));
    return adjacent && number_of(there, size) == to ? int(to) : from;
}

void follow(int spring) {
    int here = spring;
    uint cells = 1u;
    int down = down_from(here);
    while (down != here) {
        atomicAdd(brought[down], cells);
        memoryBarrierBuffer();
        if (atomicAdd(donors[down], 0xfffffffeu) != 3u) return;
        memoryBarrierBuffer();
        cells = 1u + atomicAdd(brought[down], 0u);
        here = down;
        down = down_from(here);
    }
}

void main() {
    ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
    if (!inside(texel, size)) return;
    int own = texel.y * size.x + texel.x;
    if (stage == 0) {
        int down = down_from(own);
        // The lowest bit says for good that there are donors; the others count them.
        if (down != own) {
            atomicAdd(donors[down], 2u);
            atomicOr(donors[down], 1u);
        }
    } else if (stage == 1) {
        if (donors[own] == 0u) follow(own);
    } else {
        float area = float(1u + brought[own]) * (spacing.x * spacing.y);
        imageStore(out_area, texel, vec4(area, 0.0, 0.0, 1.0));
    }
}
