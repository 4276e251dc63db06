// texturing/mipmaps/levels.glsl -- where a mip level lies in a chain of them, and what it holds.
//
//   gives    mip_corner, mip_value, mip_blend
//   needs    nothing: the chain comes as an argument
//   units    places in tiles, which repeat; levels from 0, the finest
//   source   Williams 1983, "Pyramidal Parametrics" (SIGGRAPH)
//   tested   tests/glsl/test_mipmaps.py, against the same in float64
#ifndef TEXTURING_MIPMAPS_LEVELS
#define TEXTURING_MIPMAPS_LEVELS

// The south-west texel of a level of an image that is so many texels wide.
ivec2 mip_corner(int level, int side) {
    return level == 0 ? ivec2(0) : ivec2(side, side - 2 * (side >> level));
}

// The colour of one level at a place, interpolated between its four nearest texels.
vec4 mip_value(sampler2D chain, int level, vec2 tile) {
    int side = textureSize(chain, 0).y;
    ivec2 corner = mip_corner(level, side);
    int own = side >> level;
    vec2 place = fract(tile) * float(own) - 0.5;
    vec2 low = floor(place);
    vec2 share = place - low;
    ivec2 from = (ivec2(low) + own) % own;  // the tile continues into itself
    ivec2 to = (from + 1) % own;
    vec4 south = mix(texelFetch(chain, corner + from, 0),
                     texelFetch(chain, corner + ivec2(to.x, from.y), 0), share.x);
    vec4 north = mix(texelFetch(chain, corner + ivec2(from.x, to.y), 0),
                     texelFetch(chain, corner + to, 0), share.x);
    return mix(south, north, share.y);
}

// Between two levels: trilinear.
// anchor: blend
vec4 mip_blend(sampler2D chain, float level, vec2 tile) {
    float maximum = log2(float(textureSize(chain, 0).y));
    float clamped = clamp(level, 0.0, maximum);
    int finer = int(clamped);
    vec4 fine = mip_value(chain, finer, tile);
    vec4 coarse = mip_value(chain, min(finer + 1, int(maximum)), tile);
    return mix(fine, coarse, clamped - float(finer));
}
// end: blend
#endif
