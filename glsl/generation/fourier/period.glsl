// generation/fourier/period.glsl -- of the numbers of a terrain those of one period, as the transform takes them.
//
//   gives    period: a complex number for each texel
//   needs    nothing
//   units    as the numbers
//   source   none: the first texels as they are
//   tested   tests/glsl/test_fourier.py, with the terrain
#pragma kernel(output = "period:rg32f")

uniform sampler2D numbers; //! input

vec2 kernel(ivec2 texel) {
    return texelFetch(numbers, texel, 0).rg;
}
