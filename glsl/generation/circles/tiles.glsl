// generation/circles/tiles.glsl -- which discs touch a tile of the land.
//
//   gives    touching: a bit for each of 96 discs, 24 in a channel
//   needs    generation/circles/dome.glsl, maths/whole.glsl
//   units    see generation/circles/dome.glsl
//   source   made here
//   tested   tests/glsl/test_circles.py: the land is the one without tiles
//
// A row holds a whole row of tiles for the first 96 discs, then one for the next 96, and so on.
// A disc may be marked that touches the tile only nearly; none is left out that touches it.
#include "generation/circles/dome.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "touching:rgba32f")

uniform sampler2D disc;   //! input
uniform int discs = 200;  //! slider(0, 1000) How many

const float NEARLY = 1e-4;

vec4 kernel(ivec2 texel) {
    int known = min(discs, textureSize(disc, 0).x);
    int blocks = max(quotient(discs + 95, 96), 1);
    ivec2 tiles = ivec2(max(quotient(size.x, blocks), 1), size.y);
    int block = quotient(texel.x, tiles.x);
    vec2 tile = vec2(texel.x - block * tiles.x, texel.y);
    vec2 whole = extent / land_side(extent);
    vec2 low = tile / vec2(tiles) * whole;
    vec2 high = (tile + 1.0) / vec2(tiles) * whole;
    vec4 touching = vec4(0.0);
    for (int channel = 0; channel < 4; channel++) {
        int bits = 0;
        for (int i = 0; i < 24; i++) {
            int which = block * 96 + channel * 24 + i;
            if (which >= known) break;
            vec4 one = texelFetch(disc, ivec2(which, 0), 0);
            vec2 offset = clamp(one.xy, low, high) - one.xy;
            float reach = one.z + NEARLY;
            if (dot(offset, offset) < reach * reach) bits |= 1 << i;
        }
        touching[channel] = float(bits);
    }
    return touching;
}
