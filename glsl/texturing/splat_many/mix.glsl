// texturing/splat_many/mix.glsl -- the best four of sixteen materials, mixed.
//
//   gives    colour, linear light
//   needs    maths/land.glsl, maths/nodes.glsl; texturing/splat_many/atlas and choose
//   units    a tile is `repeats` times side by side from west to east
//   source   as texturing/splat/mix.glsl; reading the atlas: made here
//   tested   tests/glsl/test_splat_many.py, against the mixture in float64
//
// It is one texture for the whole terrain.
//
// Numbers of materials cannot be interpolated: where the lists are coarser than this texture,
// each of the four around a place is mixed by itself, and then the colours between them.
#include "maths/land.glsl"
#include "maths/nodes.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D atlas;    //! input("linear", "mipmap")
uniform sampler2D chosen;   //! input
uniform sampler2D weights;  //! input

uniform float repeats = 48.0;  //! slider(1, 512) step(1)
                               //! How often a tile repeats from west to east

// A place in a cell of the atlas, in tiles, between the four texels around it; the cell meets
// its own copy. `cell` is a power of two.
vec3 tile_at(int number, vec2 place, int level, int cell) {
    vec2 at = fract(place) * float(cell) - 0.5;
    ivec2 low = ivec2(floor(at));
    vec2 part = at - vec2(low);
    ivec2 base = ivec2(number & 3, number >> 2) * cell;
    ivec2 here = low & (cell - 1);
    ivec2 next = (low + 1) & (cell - 1);
    vec3 south = mix(texelFetch(atlas, base + here, level).rgb,
                     texelFetch(atlas, base + ivec2(next.x, here.y), level).rgb, part.x);
    vec3 north = mix(texelFetch(atlas, base + ivec2(here.x, next.y), level).rgb,
                     texelFetch(atlas, base + next, level).rgb, part.x);
    return mix(south, north, part.y);
}

vec3 mixed_at(ivec2 node, vec2 place, int level, int cell) {
    vec4 numbers = floor(texelFetch(chosen, node, 0) * 255.0 + 0.5);
    vec4 share = texelFetch(weights, node, 0);
    return share.x * tile_at(int(numbers.x), place, level, cell)
            + share.y * tile_at(int(numbers.y), place, level, cell)
         + share.z * tile_at(int(numbers.z), place, level, cell)
                 + share.w * tile_at(int(numbers.w), place, level, cell);
}

vec4 kernel(ivec2 texel) {
    int whole = max(textureSize(atlas, 0).x / 4, 1);
    float texels = float(max(size.x - 1, 1)) / repeats;
    float finest = log2(float(whole));
    int level = int(clamp(floor(log2(float(whole) / texels) + 0.5), 0.0, finest));
    int cell = whole >> level;
    vec2 tile = share_of_texel(texel, size) * repeats * vec2(1.0, extent.y / extent.x);

    ivec2 grid = textureSize(chosen, 0);
    Nodes around = nodes_around(place_on(grid, texel, size));
    vec3 total = vec3(0.0);
    for (int k = 0; k < around.count; k++) {
        total += weight_of(around, k) * mixed_at(node_at(around, k), tile, level, cell);
    }
    return vec4(total, 1.0);
}
