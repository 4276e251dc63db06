// generation/fourier/repeated.glsl -- a texture's real part, begun again where it ends.
//
//   gives    height
//   needs    nothing
//   units    as the numbers
//   source   Belaiche 2010, section 1.3.3: one side is like the side across
//   tested   tests/glsl/test_fourier.py, by first and last rows and columns
//
// For a terrain of 2^n or 2^n + 1 texels along each side, from one period of 2^n.
#pragma kernel(output = "height:r32f", \
               accepts = "2**(n + 1) or 2**n + 1, 2**(m + 1) or 2**m + 1")

uniform sampler2D numbers; //! input

float kernel(ivec2 texel) {
    ivec2 period = textureSize(numbers, 0);
    return texelFetch(numbers, texel - period * ivec2(greaterThanEqual(texel, period)), 0).r;
}
