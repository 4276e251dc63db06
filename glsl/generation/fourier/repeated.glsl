// generation/fourier/repeated.glsl -- a texture's real part, begun again where it ends, or cut short.
//
//   gives    height
//   needs    nothing
//   units    as the numbers
//   source   Belaiche 2010, section 1.3.3: one side is like the side across
//   tested   tests/glsl/test_fourier.py, by first and last rows and columns
//
// Of numbers one texel larger than this it takes those that are not repeated yet.
#pragma kernel(output = "height:r32f")

uniform sampler2D numbers; //! input

float kernel(ivec2 texel) {
    ivec2 period = textureSize(numbers, 0);
    return texelFetch(numbers, texel - period * ivec2(greaterThanEqual(texel, period)), 0).r;
}
