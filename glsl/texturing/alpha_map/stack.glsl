// texturing/alpha_map/stack.glsl -- four layers' weights: what covers what, and paint.
//
//   gives    weights, red to alpha: of grass, which lies everywhere, of rock, snow and a path over
//            it
//   needs    maths/land.glsl, texturing/splat_weights.glsl; covers 0..1 and a mask, each of any
//            size, each if there is one
//   units    covers, masks and weights 0..1; in every texel the weights sum to 1
//   source   Belaiche 2010, sections 2.5 and 2.6
//   tested   tests/glsl/test_splat_rules.py: the sum in whole bytes, and each layer over the
//            others
//
// 8 bits a channel, as a file would have; the four bytes of a texel sum to 255, and so do
// those between texels, since interpolation is linear.
//
// A painted mask has four weights as well. Where its numbers sum to 1 or more it alone counts,
// where they sum to 0 it does not, and between them in proportion: a soft brush fades out.
#include "maths/land.glsl"
#include "texturing/splat_weights.glsl"
#pragma kernel(output = "weights:rgba8")

uniform sampler2D rock;     //! input("black")
uniform sampler2D snow;     //! input("black")
uniform sampler2D path;     //! input("black")
uniform sampler2D painted;  //! input("black")

uniform int layers = 4;     //! slider(1, 4) How many layers there are, from the first on

// The mean of the four texels around a place, by how near they are.
vec4 around(sampler2D field, ivec2 texel) {
    ivec2 grid = textureSize(field, 0);
    vec2 place = place_on(grid, texel, size);
    ivec2 low = ivec2(place);
    ivec2 high = min(low + 1, grid - 1);
    vec2 part = place - vec2(low);
    vec4 south = texelFetch(field, low, 0) + (texelFetch(field, ivec2(high.x, low.y), 0)
                                              - texelFetch(field, low, 0)) * part.x;
    vec4 north = texelFetch(field, ivec2(low.x, high.y), 0)
            + (texelFetch(field, high, 0) - texelFetch(field, ivec2(low.x, high.y), 0)) * part.x;
    return south + (north - south) * part.y;
}

vec4 kernel(ivec2 texel) {
    vec3 covers = vec3(around(rock, texel).r, around(snow, texel).r, around(path, texel).r);
    covers *= vec3(greaterThan(ivec3(layers), ivec3(1, 2, 3)));
    vec4 weights = weights_of_covers(covers);
    // What is not wired is one black texel, whose alpha is 1 all the same.
    if (textureSize(painted, 0).x > 1) {
        vec4 taken = vec4(greaterThanEqual(ivec4(layers), ivec4(1, 2, 3, 4)));
        vec4 mask = around(painted, texel) * taken;
        float share = min(mask.x + mask.y + mask.z + mask.w, 1.0);
        weights = mix(weights, weights_of_mask(mask), share);
    }
    return weights_in_bytes(weights);
}
