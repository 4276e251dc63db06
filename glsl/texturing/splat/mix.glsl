// texturing/splat/mix.glsl -- one texture for the terrain from four layers by weights.
//
//   gives    colour, linear light
//   needs    maths/land.glsl, texturing/splat_weights.glsl; weights as of texturing/alpha_map,
//            four colours for the whole terrain, and texturing/splat/means of their tiles; each
//            of any size
//   units    weights 0..1; contrast: odds are multiplied by e^contrast for a material twice as
//            bright as its mean
//   source   Belaiche 2010, section 2.5; by heights: the idea of Mishkinis 2013, "Advanced
//            Terrain Texture Splatting", the formula made here
//   tested   tests/glsl/test_splat.py, against the mixture in float64
//
// What protrudes from a material is bright in these tiles and its cracks are dark, so its
// brightness over its mean is taken for its own height.
//
// rgba16f: linear light in 8 bits leaves 13 steps below the grass's mean.
#include "maths/land.glsl"
#include "texturing/splat_weights.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D weights;  //! input("linear")
uniform sampler2D grass;    //! input
uniform sampler2D rock;     //! input
uniform sampler2D snow;     //! input
uniform sampler2D path;     //! input
uniform sampler2D means;    //! input

uniform int blend = 0;           //! menu("even", "by heights") group("Blend")
                                 //! How materials mix where they meet: as in a mist, or what
                                 //! is higher comes through
uniform float contrast = 6.0;    //! slider(0, 20) step(0.1) group("Blend")
                                 //! How strictly heights decide; 0 is even

vec3 nearest(sampler2D field, ivec2 texel) {
    return texelFetch(field, ivec2(place_on(textureSize(field, 0), texel, size) + 0.5), 0).rgb;
}

vec4 kernel(ivec2 texel) {
    // Between texels of weights that sum to 1 so does their mean.
    ivec2 grid = textureSize(weights, 0);
    vec4 share = textureLod(weights, (place_on(grid, texel, size) + 0.5) / vec2(grid), 0.0);
    vec3 one = nearest(grass, texel);
    vec3 two = nearest(rock, texel);
    vec3 three = nearest(snow, texel);
    vec3 four = nearest(path, texel);
    if (blend == 1) {
        vec4 bright = vec4(one.g, two.g, three.g, four.g);
        share = weights_by_heights(share, bright / texelFetch(means, ivec2(0), 0), contrast);
    }
    return vec4(share.x * one + share.y * two + share.z * three + share.w * four, 1.0);
}
