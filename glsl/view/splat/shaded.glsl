// view/splat/shaded.glsl -- the splatted terrain, shaded once at each pixel that shows it.
//
//   gives    frame, linear light, over an earlier frame
//   needs    texturing/splat_weights.glsl, view/ground_texel.glsl, view/surface.glsl; what
//            view/ground gives, weights as of texturing/alpha_map, four tiles; a light and
//            texturing/splat/means if there are
//   units    metres; colours linear; a tile is so many times side by side from west to east
//   source   as view/splat/land.glsl, whose picture it is
//   tested   tests/glsl/test_view_ground.py, against view/splat/land
//
// The second draw of view/splat/land.fast.toml. At crests, four pixels of a square may show two
// slopes; there a renderer without a GPU takes all four from the levels of one of them.
#include "texturing/splat_weights.glsl"
#include "view/ground_texel.glsl"
#include "view/surface.glsl"
#pragma draw(mesh = "sheet", output = "frame:rgba16f", over = "ground", samples = 1)

uniform sampler2D ground;   //! input
uniform sampler2D weights;  //! input("linear", "mipmap")
uniform sampler2D grass;    //! input("linear", "repeat", "mipmap")
uniform sampler2D rock;     //! input("linear", "repeat", "mipmap")
uniform sampler2D snow;     //! input("linear", "repeat", "mipmap")
uniform sampler2D path;     //! input("linear", "repeat", "mipmap")
uniform sampler2D means;    //! input("white")
uniform sampler2D light;    //! input("linear", "mipmap", "white")

#include "view/parameters/earth.glsl"
#include "view/parameters/layers.glsl"
#include "view/parameters/haze.glsl"

vec4 vertex(vec3 corner, out vec2 pixel, out vec3 ray) {
    pixel = corner.xy * vec2(size);
    ray = ray_through(clip_from_world, corner.xy);
    return vec4(corner.xy * 2.0 - 1.0, 1.0, 1.0);
}

vec4 fragment(vec2 pixel, vec3 ray) {
    Ground seen = ground_of_texel(texelFetch(ground, ivec2(pixel), 0).rg, ray);
    vec2 share = seen.place / extent, moves = seen.change / extent;
    vec2 square = vec2(1.0, extent.y / extent.x);
    vec2 tile = share * square, over = moves * square;
    vec3 one = texture_on_ground(grass, tile * grass_repeats, over * grass_repeats, 0.0).rgb;
    vec3 two = texture_on_ground(rock, tile * rock_repeats, over * rock_repeats, 0.0).rgb;
    vec3 three = texture_on_ground(snow, tile * snow_repeats, over * snow_repeats, 0.0).rgb;
    vec3 four = texture_on_ground(path, tile * path_repeats, over * path_repeats, 0.0).rgb;
    vec4 weight = draped_on_ground(weights, share, moves, 0.0);
    weight /= weight.x + weight.y + weight.z + weight.w;
    if (blend == 1) {
        weight = weights_by_heights(weight, vec4(one.g, two.g, three.g, four.g)
                                    / texelFetch(means, ivec2(0), 0), contrast);
    }
    vec3 shown = weight.x * one + weight.y * two + weight.z * three + weight.w * four;
    vec3 lit = shown * draped_on_ground(light, share, moves, SHARPER).rgb;
    vec3 colour = cut_or(lit, earth, share, seen.mark);
    return vec4(through_air(colour, horizon, haze, seen.eye_distance, extent), 1.0);
}
