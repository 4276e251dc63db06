// view/splat/land.glsl -- the terrain, four textures mixed at every pixel by their weights.
//
//   gives    frame, linear light, over an earlier frame
//   needs    maths/drape.glsl, texturing/splat_weights.glsl, view/splat/surface.glsl,
//            view/surface.glsl, view/vertices.glsl; a height 0..1, weights as of
//            texturing/alpha_map, four tiles; a light and texturing/splat/means if there are, and
//            for tiles of the mesh what view/geomipmap/errors gives
//   units    metres; colours linear; a tile is so many times side by side from west to east
//   source   Belaiche 2010, section 2.5, figure 2.9; by heights: see texturing/splat/mix.glsl
//   tested   tests/glsl/test_splat_view.py, against the same mixture baked, and against float64
//
// Five textures are read for each pixel, so that near ground is as fine as the tiles and not
// as the largest texture that fits in memory.
#include "maths/drape.glsl"
#include "texturing/splat_weights.glsl"
#include "view/splat/surface.glsl"
#include "view/surface.glsl"
#include "view/vertices.glsl"
#pragma draw(mesh = "land", output = "frame:rgba16f")

#include "view/parameters/mesh.glsl"
uniform sampler2D weights;  //! input("linear", "mipmap")
uniform sampler2D grass;    //! input("linear", "repeat", "mipmap")
uniform sampler2D rock;     //! input("linear", "repeat", "mipmap")
uniform sampler2D snow;     //! input("linear", "repeat", "mipmap")
uniform sampler2D path;     //! input("linear", "repeat", "mipmap")
uniform sampler2D means;    //! input("white")
uniform sampler2D light;    //! input("linear", "mipmap", "white")

#include "view/parameters/layers.glsl"
#include "view/parameters/haze.glsl"

vec4 vertex(vec3 corner, vec4 tile, out vec3 position, out float mark) {
    return vertex_of_mesh(height, detail, corner, tile, skirt, position, mark);
}

vec4 fragment(vec3 position, float mark) {
    vec2 share = position.xy / extent;
    // Tiles are square on the ground, so a long terrain has more of them along its length.
    vec2 tile = share * vec2(1.0, extent.y / extent.x);
    vec3 one = texture(grass, tile * grass_repeats).rgb;
    vec3 two = texture(rock, tile * rock_repeats).rgb;
    vec3 three = texture(snow, tile * snow_repeats).rgb;
    vec3 four = texture(path, tile * path_repeats).rgb;
    vec4 weight = weights_seen(weights, share);
    if (blend == 1) {
        weight = weights_by_heights(weight, vec4(one.g, two.g, three.g, four.g)
                                    / texelFetch(means, ivec2(0), 0), contrast);
    }
    vec3 shown = weight.x * one + weight.y * two + weight.z * three + weight.w * four;
    return vec4(surface_seen(shown, light, position, mark, earth, horizon, haze), 1.0);
}
