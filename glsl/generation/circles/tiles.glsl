// generation/circles/tiles.glsl -- which discs touch a tile of the terrain.
//
//   gives    touching: 96 marks, see generation/marks.glsl
//   needs    generation/circles/dome.glsl, generation/marks.glsl, maths/whole.glsl
//   units    see generation/circles/dome.glsl
//   source   made here
//   tested   tests/glsl/test_marks.py, as part of the fast variant
//
// A disc may be marked that touches the tile only nearly; none is left out that touches it.
#include "generation/circles/dome.glsl"
#include "generation/marks.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "touching:rgba32f")

uniform sampler2D disc;   //! input
uniform int discs = 200;  //! slider(0, 1000) As in the technique

const float NEARLY = 1e-4;

bool touches(vec4 one, vec2 low, vec2 high) {
    vec2 offset = clamp(one.xy, low, high) - one.xy;
    float near = one.z + NEARLY;
    return dot(offset, offset) < near * near;
}

vec4 kernel(ivec2 texel) {
    int known = min(discs, textureSize(disc, 0).x);
    ivec3 grid = tile_grid(size, discs);
    int block = quotient(texel.x, grid.x);
    vec2 tile = vec2(texel.x - block * grid.x, texel.y);
    vec2 whole = extent / shorter_side(extent);
    vec2 low = tile / vec2(grid.xy) * whole;
    vec2 high = (tile + 1.0) / vec2(grid.xy) * whole;
    vec4 touching = vec4(0.0);
    for (int channel = 0; channel < 4; channel++) {
        int bits = 0;
        for (int i = 0; i < MARKS_A_CHANNEL; i++) {
            int which = block * MARKS + channel * MARKS_A_CHANNEL + i;
            if (which >= known) break;
            if (touches(texelFetch(disc, ivec2(which, 0), 0), low, high)) bits |= 1 << i;
        }
        touching[channel] = float(bits);
    }
    return touching;
}
