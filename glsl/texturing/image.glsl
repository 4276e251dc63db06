// texturing/image.glsl -- an image file as a texture: a tile, or one picture of it all.
//
//   gives    colour, linear light
//   needs    maths/land.glsl; an image file, PNG, JPEG or WebP, of any size
//   units    none
//   source   made here, for the photographs of Belaiche 2010, sections 2.2 and 2.3
//   tested   tests/glsl/test_texturing_drape.py, against Pillow and the sRGB curve in float64
//
// The engine decodes sRGB before anything is averaged. A larger image is read at the level of
// detail that suits this pass's size, a smaller one is interpolated. Its alpha is left out.
//
// As a tile, this pass's texels divide the image evenly, so that it meets its own copy: what
// texturing/tiled and texturing/hex_tiled repeat. Over the terrain, the outermost texels are on
// the terrain's edges, as in every texture of the whole terrain, and so do the image's edges; an
// image of other proportions than the terrain's is stretched.
#include "maths/land.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D image;  //! file("sketches/data/jacksboro_from_above.jpg", "linear", "repeat",
                          //! "mipmap")
                          //! PNG, JPEG or WebP, north on top
uniform int fit = 0;      //! menu("tile", "land")
                          //! Whether its texels divide the image evenly, as a tile's, or the
                          //! outermost are on the terrain's edges

vec4 kernel(ivec2 texel) {
    vec2 texels = vec2(textureSize(image, 0));
    vec2 shrunk = texels / vec2(fit == 1 ? max(size - 1, ivec2(1)) : size);
    float level = max(log2(max(shrunk.x, shrunk.y)), 0.0);
    vec2 place = fit == 1 ? share_of_texel(texel, size) : (vec2(texel) + 0.5) / vec2(size);
    if (fit == 1) {
        // Nothing of the opposite edge.
        vec2 half_texel = min(0.5 * exp2(ceil(level)) / texels, vec2(0.5));
        place = clamp(place, half_texel, 1.0 - half_texel);
    }
    return vec4(textureLod(image, place, level).rgb, 1.0);
}
