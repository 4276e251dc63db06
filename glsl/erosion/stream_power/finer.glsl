// erosion/stream_power/finer.glsl -- the same terrain and the same rivers on a grid twice as fine.
//
//   gives    height, receiver: where each texel drains to, along the rivers that there are
//   needs    maths/land.glsl, noise/hash.glsl, terrain/heightfield.glsl, water/texels.glsl
//   units    heights without unit; roughness in metres per metre
//   source   made here; a middle displaced sideways is Fournier, Fussell and Carpenter 1982,
//            "Computer rendering of stochastic models", section 4
//   tested   tests/glsl/test_stream_power.py: every way goes through the same coarse texels
//
// Texel k of the coarse grid is texel 2 k of the fine one. A river's stretch from one coarse texel
// to the next goes through the fine texel in the middle, at the mean height; some of those along
// an axis bend through the middle of the square beside it, so that no river stays straight. All
// other new texels are raised a little, at random, and drain to the lowest coarse texel around.
// Where two stretches meet in a middle both go on to the lower end: levels fall along every
// stretch, so that no way goes in a circle. Edges have the heights that they began with. A grid of the same size stays as it is.
#include "maths/land.glsl"
#include "noise/hash.glsl"
#include "terrain/heightfield.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "height:r32f, receiver:r32f")

uniform sampler2D start;            //! input
uniform sampler2D coarse;           //! input
uniform sampler2D coarse_receiver;  //! input
uniform sampler2D coarse_level;     //! input
uniform float roughness = 0.05;     //! slider(0, 1) step(0.01) How far new texels are raised
uniform float winding = 0.5;        //! slider(0, 1) step(0.01) Share of the straight stretches
                                    //! that bend
uniform uint seed = 1u;             //! slider(0, 9999) Which ones

const uint SALT = 0xd18f9355u;  // CRC-32 of "erosion/stream_power/finer"

ivec2 grid() { return textureSize(coarse, 0); }

// The coarse texel that a coarse texel drains to: a neighbour, or itself.
ivec2 end_of(ivec2 from) {
    ivec2 to = texel_of(texelFetch(coarse_receiver, from, 0).r, grid());
    return from + clamp(to - from, ivec2(-1), ivec2(1));
}

// The fine texel in the middle of a coarse texel's stretch.
ivec2 middle_of(ivec2 from) {
    ivec2 along = end_of(from) - from;
    vec2 drawn = random_pair(from, seed + SALT + uint(size.x));
    bool bends = along.x * along.y == 0 && along != ivec2(0) && drawn.x < winding;
    ivec2 aside = bends ? along.yx * (drawn.y < 0.5 ? -1 : 1) : ivec2(0);
    return 2 * from + along + aside;
}

void kernel(ivec2 texel, out float height, out float receiver) {
    ivec2 last = grid() - 1;
    ivec2 south_west = min(texel / 2, last);
    ivec2 odd = min(texel - 2 * south_west, 1);
    ivec2 far = min(south_west + odd, last);
    receiver = number_of(texel, size);
    if (grid() == size) {
        height = texelFetch(coarse, texel, 0).r;
        receiver = texelFetch(coarse_receiver, texel, 0).r;
        return;
    }
    if (on_edge(texel, size)) {
        height = height_at(start, place_on(textureSize(start, 0), texel, size));
        return;
    }
    if (odd == ivec2(0)) {
        height = texelFetch(coarse, south_west, 0).r;
        // Of an even size the last column or row is new, and what was an edge drains to it.
        ivec2 to = middle_of(south_west);
        if (to == texel) to += ivec2(equal(south_west, last));
        receiver = number_of(to, size);
        return;
    }
    float sum = 0.0;
    float river = 1e30;
    float lowest = 1e30;
    float lowest_end = 1e30;
    ivec2 beside = south_west;
    ivec2 end = south_west;
    for (int k = 0; k < 4; k++) {
        ivec2 corner = ivec2((k & 1) == 0 ? south_west.x : far.x, k < 2 ? south_west.y : far.y);
        float ground = texelFetch(coarse, corner, 0).r;
        float level = texelFetch(coarse_level, corner, 0).r;
        sum += 0.25 * ground;
        if (level < lowest) {
            lowest = level;
            beside = corner;
        }
        ivec2 to = end_of(corner);
        if (to == corner || middle_of(corner) != texel) continue;
        river = min(river, 0.5 * (ground + texelFetch(coarse, to, 0).r));
        level = texelFetch(coarse_level, to, 0).r;
        if (level < lowest_end) {
            lowest_end = level;
            end = to;
        }
    }
    float raised = roughness * min(spacing.x, spacing.y) / max(relief, 1e-3);
    float lift = raised * random(texel, seed + SALT + uint(size.x) + 1u);
    height = river < 1e29 ? river : sum + lift;
    receiver = number_of(2 * (river < 1e29 ? end : beside), size);
}
