// texturing/tiled.glsl -- an image tiled over the terrain, without visible repeats.
//
//   gives    colour, linear light
//   needs    maths/land.glsl, texturing/tile_over_land.glsl; an image that repeats
//   units    the image is `repeats` times side by side from west to east
//   source   Belaiche 2010, section 2.3.3, without the second reading; less detail: section 5.5
//   tested   tests/glsl/test_height_blend.py: so many repeats, the image's mean where they are
//            too fine, and less contrast about the same mean where less detail is wanted
//
// The thesis takes texel (i, j) of the image, modulo its size. Here the image repeats so
// many times over the terrain, at any size of either, and is read at the level of
// detail where its texels are as large as this texture's: read at level 0, a fine image
// in a small texture is a few texels picked at random.
//
// Section 5.5 finds that details of a texture are taken for the terrain's, and takes a texture of
// less detail for figures 5.10 and 5.11. Here that is the same image with less contrast about
// its mean, which the last level of detail holds: so it works for a user's image too, and the
// terrain keeps its colours.
//
// rgba16f: linear light in 8 bits leaves 13 steps below the grass's mean.
#include "maths/land.glsl"
#include "texturing/tile_over_land.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D colour;  //! input("linear", "repeat", "mipmap")

uniform float repeats = 24.0;      //! slider(1, 256) step(1)
                                   //! How often the images repeat from west to east
uniform float variety = 0.5;       //! slider(0, 1) step(0.01)
                                   //! How much of each image is read a second time, larger and
                                   //! turned, so that its repeats do not show
uniform float detail = 1.0;        //! slider(0, 1) step(0.01)
                                   //! How much of each image's contrast is left. 0: its mean
                                   //! colour

vec4 kernel(ivec2 texel) {
    // Tiles are square on the ground, so a long terrain has more of them along its length.
    vec2 tile = share_of_texel(texel, size) * repeats * vec2(1.0, extent.y / extent.x);
    float texels = float(max(size.x - 1, 1)) / repeats;
    vec3 shown = tile_over_land(colour, tile, texels, variety);
    // The level after the last is the last: one texel, the mean.
    if (detail < 1.0) shown = mix(textureLod(colour, vec2(0.5), 99.0).rgb, shown, detail);
    return vec4(shown, 1.0);
}
