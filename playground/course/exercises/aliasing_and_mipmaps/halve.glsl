// texturing/mipmaps/chain.glsl -- a square image at all its mip levels.
//
//   gives    chain: level 0 on the left, the others one above the other on its right
//   needs    texturing/mipmaps/levels.glsl; an image whose side is a power of two; 3/2 of its size
//            by 1
//   units    those of the image
//   source   Williams 1983, "Pyramidal Parametrics" (SIGGRAPH), whose layout this resembles
//   tested   tests/glsl/test_mipmaps.py, against means over blocks in float64
#include "texturing/mipmaps/levels.glsl"
#pragma kernel(output = "chain:rgba32f", repeat = "bits(size.y)")

uniform sampler2D image;  //! input

vec4 kernel(ivec2 texel) {
    int side = size.y >> iteration;                     // texels of this level
    ivec2 at = texel - mip_corner(iteration, size.y);   // where in the level
    if (any(lessThan(at, ivec2(0))) || any(greaterThanEqual(at, ivec2(side)))) {
        return previous(texel);                         // another level's: as it is
    }
    if (iteration == 0) return texelFetch(image, at, 0);
    ivec2 finer = mip_corner(iteration - 1, size.y) + 2 * at;
    return previous(finer);
}
