// texturing/splat/tiled_mix.glsl -- four tiles laid over the terrain and mixed, in one go.
//
//   gives    colour, linear light, as texturing/splat does in five passes
//   needs    maths/land.glsl, texturing/splat_weights.glsl, texturing/tile_over_land.glsl;
//            weights as of texturing/alpha_map, of any size, four tiles that repeat, and
//            texturing/splat/means of these
//   units    weights 0..1; repeats from west to east; contrast as in texturing/splat/mix
//   source   Belaiche 2010, sections 2.3.3 and 2.5
//   tested   tests/glsl/test_splat.py and `playground variants verify`, against the five passes
//
// Four layers of the terrain's size, 8 bytes a texel each, are neither written nor read again,
// and are not rounded to halves in between.
#include "maths/land.glsl"
#include "texturing/splat_weights.glsl"
#include "texturing/tile_over_land.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D weights;  //! input("linear")
uniform sampler2D grass;    //! input("linear", "repeat", "mipmap")
uniform sampler2D rock;     //! input("linear", "repeat", "mipmap")
uniform sampler2D snow;     //! input("linear", "repeat", "mipmap")
uniform sampler2D path;     //! input("linear", "repeat", "mipmap")
uniform sampler2D means;    //! input

uniform int blend = 0;           //! menu("even", "by heights") group("Blend")
                                 //! How materials mix where they meet: as in a mist, or what
                                 //! is higher comes through
uniform float contrast = 6.0;    //! slider(0, 20) step(0.1) group("Blend")
                                 //! How strictly heights decide; 0 is even
uniform float variety = 0.5;     //! slider(0, 1) step(0.01)
                                 //! How much of each image is read a second time, larger and
                                 //! turned, so that its repeats do not show
uniform float grass_repeats = 24.0;  //! slider(1, 256) step(1)
                                     //! How often grass repeats from west to east
uniform float rock_repeats = 24.0;   //! slider(1, 256) step(1)
                                     //! How often rock repeats from west to east
uniform float snow_repeats = 24.0;   //! slider(1, 256) step(1)
                                     //! How often snow repeats from west to east
uniform float path_repeats = 24.0;   //! slider(1, 256) step(1)
                                     //! How often the path repeats from west to east

vec3 layer(sampler2D image, ivec2 texel, float repeats) {
    vec2 tile = share_of_texel(texel, size) * repeats * vec2(1.0, extent.y / extent.x);
    return tile_over_land(image, tile, float(max(size.x - 1, 1)) / repeats, variety);
}

vec4 kernel(ivec2 texel) {
    // Between texels of weights that sum to 1 so does their mean.
    ivec2 grid = textureSize(weights, 0);
    vec4 share = textureLod(weights, (place_on(grid, texel, size) + 0.5) / vec2(grid), 0.0);
    vec3 one = layer(grass, texel, grass_repeats);
    vec3 two = layer(rock, texel, rock_repeats);
    vec3 three = layer(snow, texel, snow_repeats);
    vec3 four = layer(path, texel, path_repeats);
    if (blend == 1) {
        vec4 bright = vec4(one.g, two.g, three.g, four.g);
        share = weights_by_heights(share, bright / texelFetch(means, ivec2(0), 0), contrast);
    }
    return vec4(share.x * one + share.y * two + share.z * three + share.w * four, 1.0);
}
