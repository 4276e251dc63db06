// water/fill/flood.glsl -- depressions filled to where they spill, by lowering a flood.
//
//   gives    level, of the water's surface, or of the ground where it is dry
//   needs    water/least_fall.glsl, water/texels.glsl
//   units    heights without unit
//   source   Planchon and Darboux 2002, "A fast, simple and versatile algorithm to fill the
//            depressions of digital elevation models", Catena 46: from above, with a little fall
//   tested   tests/glsl/test_fill.py, against a priority flood
//
// In each step the flood falls to the ground, or to what the lowest neighbour lets out. It comes
// from above: after any number of steps each texel but an edge's has a neighbour below its level,
// so all water drains, and further steps only lower the flood where a shorter way out is known.
// A way out has no more texels than the terrain, so the steps of 0 are enough for any terrain.
#include "water/least_fall.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "level:r32f", repeat = "steps if steps > 0 else size.x * size.y", \
               until = "unchanged")

uniform sampler2D height;  //! input
uniform int steps = 0;     //! slider(0, 65536) Texels over which a way out is sought, at most;
                           //! 0: until nothing changes

float kernel(ivec2 texel) {
    float ground = texelFetch(height, texel, 0).r;
    if (on_edge(texel, size)) return ground;
    vec3 falls = falls_between(spacing, relief);
    // anchor: flood
    float west_east = min(previous(texel - ivec2(1, 0)), previous(texel + ivec2(1, 0)));
    float south_north = min(previous(texel - ivec2(0, 1)), previous(texel + ivec2(0, 1)));
    float rising = min(previous(texel - 1), previous(texel + 1));
    float falling = min(previous(texel + ivec2(-1, 1)), previous(texel + ivec2(1, -1)));
    float straight = min(west_east + falls.x, south_north + falls.y);
    return max(ground, min(straight, min(rising, falling) + falls.z));
    // end: flood
}
