// texturing/mipmaps/difference.glsl -- how far two pictures differ, pixel by pixel.
//
//   gives    difference: of their red, 0 and up
//   needs    two pictures of this size
//   units    those of the pictures
//   source   none: a difference
//   tested   tests/glsl/test_mipmaps.py, against NumPy
#pragma kernel(output = "difference:r32f")

uniform sampler2D first;   //! input
uniform sampler2D second;  //! input

float kernel(ivec2 texel) {
    return abs(texelFetch(first, texel, 0).r - texelFetch(second, texel, 0).r);
}
