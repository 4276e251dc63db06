// water/levels/finer.glsl -- the same terrain and the same rivers on a grid twice as fine.
//
//   gives    height, receiver: where each texel drains to, along the rivers that there are
//   needs    water/levels/parameters/keep.glsl, maths/land.glsl, noise/hash.glsl,
//            terrain/heightfield.glsl, water/texels.glsl
//   units    heights without unit; roughness in metres per metre
//   source   made here; a middle displaced sideways is Fournier, Fussell and Carpenter 1982,
//            "Computer rendering of stochastic models", section 4
//   tested   tests/glsl/test_stream_power.py: every way goes through the same coarse texels
//
// Texel k of the coarse grid is texel 2 k of the fine one. A river's stretch from one coarse texel
// to the next goes through the fine texel in the middle, at the mean height. Some stretches bend,
// so that no river stays straight: along an axis through the middle of a square beside, along a
// diagonal round one of the sides, by two fine texels. All other new texels are raised a little,
// at random, and drain to the lowest coarse texel around. Where stretches meet, all go on to the
// lowest end: levels fall along every stretch, so that no way goes in a circle. Edges have the
// heights that they began with. A grid of the same size stays as it is.
#include "water/levels/parameters/keep.glsl"
#include "maths/land.glsl"
#include "noise/hash.glsl"
#include "terrain/heightfield.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "height:r32f, receiver:r32f", \
               accepts = "n up to 4096, m up to 4096")

uniform sampler2D start;            //! input
uniform sampler2D coarse;           //! input
uniform sampler2D coarse_receiver;  //! input
uniform sampler2D coarse_level;     //! input
uniform float roughness = 0.05;     //! slider(0, 1) step(0.01) How far new texels are raised
uniform float winding = 0.6;        //! slider(0, 1) step(0.01) Share of the stretches that bend
uniform uint seed = 1u;             //! slider(0, 9999) Which ones

const uint SALT = 0xa72d9128u;  // CRC-32 of "water/levels/finer"

ivec2 grid() { return textureSize(coarse, 0); }

// The coarse texel that a coarse texel drains to: a neighbour, or itself.
ivec2 end_of(ivec2 from) {
    ivec2 to = texel_of(texelFetch(coarse_receiver, from, 0).r, grid());
    return from + clamp(to - from, ivec2(-1), ivec2(1));
}

// A stretch: the coarse texel at its end, and the one or two fine texels on its way there.
struct Stretch {
    ivec2 end;
    ivec2 first;
    ivec2 second;
};

Stretch stretch_of(ivec2 from) {
    ivec2 end = end_of(from);
    ivec2 along = end - from;
    ivec2 middle = 2 * from + along;
    Stretch straight = Stretch(end, middle, middle);
    vec2 drawn = random_pair(from, seed + SALT + uint(size.x));
    if (along == ivec2(0) || drawn.x >= winding) return straight;
    bool side = drawn.y < 0.5;
    if (along.x * along.y == 0) {
        middle += along.yx * (side ? -1 : 1);
        return Stretch(end, middle, middle);
    }
    ivec2 begin = side ? ivec2(along.x, 0) : ivec2(0, along.y);
    Stretch bent = Stretch(end, 2 * from + begin, 2 * from + begin + along);
    if (on_edge(bent.second, size)) return straight;
    return bent;
}

// The second texel of a diagonal's bend is 1 + sqrt(2) of its 2 + sqrt(2) along.
const float SECOND = 0.70710678;

void kernel(ivec2 texel, out float height, out float receiver) {
    ivec2 last = grid() - 1;
    ivec2 south_west = min(texel / 2, last);
    ivec2 odd = min(texel - 2 * south_west, 1);
    receiver = number_of(texel, size);
    if (grid() == size) {
        height = texelFetch(coarse, texel, 0).r;
        receiver = texelFetch(coarse_receiver, texel, 0).r;
        return;
    }
    if (on_edge(texel, size)) {
        height = keep * height_at(start, place_on(textureSize(start, 0), texel, size));
        return;
    }
    if (odd == ivec2(0)) {
        height = texelFetch(coarse, south_west, 0).r;
        // Of an even size the last column or row is new, and what was an edge drains to it.
        ivec2 to = stretch_of(south_west).first;
        if (to == texel) to += ivec2(equal(south_west, last));
        receiver = number_of(to, size);
        return;
    }
    float sum = 0.0;
    float corners = 0.0;
    float river = 1e30;
    float lowest = 1e30;
    float lowest_end = 1e30;
    ivec2 lowest_corner = texel;
    ivec2 next = texel;
    // Stretches that may come through here begin at the coarse texels around.
    ivec2 low = max(south_west - 1 + odd, 0);
    ivec2 high = min(south_west + 1, last);
    for (int y = low.y; y <= high.y; y++) {
        for (int x = low.x; x <= high.x; x++) {
            ivec2 from = ivec2(x, y);
            float ground = texelFetch(coarse, from, 0).r;
            if (all(lessThanEqual(abs(texel - 2 * from), ivec2(1)))) {
                sum += ground;
                corners += 1.0;
                float level = texelFetch(coarse_level, from, 0).r;
                if (level < lowest) {
                    lowest = level;
                    lowest_corner = 2 * from;
                }
            }
            Stretch stretch = stretch_of(from);
            bool second = texel == stretch.second;
            if (stretch.end == from || !(second || texel == stretch.first)) continue;
            bool alone = stretch.first == stretch.second;
            float part = alone ? 0.5 : second ? SECOND : 1.0 - SECOND;
            river = min(river, mix(ground, texelFetch(coarse, stretch.end, 0).r, part));
            float level = texelFetch(coarse_level, stretch.end, 0).r;
            if (level < lowest_end) {
                lowest_end = level;
                next = second ? 2 * stretch.end : stretch.second;
            }
        }
    }
    float raised = roughness * min(spacing.x, spacing.y) / max(relief, 1e-3);
    float lift = raised * random(texel, seed + SALT + uint(size.x) + 1u);
    bool on_river = river < 1e29;
    height = on_river ? river : sum / corners + lift;
    receiver = number_of(on_river ? next : lowest_corner, size);
}
