// generation/fourier/magnitude.glsl -- how strong each wave is, the slowest in the middle.
//
//   gives    magnitude
//   needs    nothing
//   units    1 is what random numbers between -1 and 1 have on average, 0 is `decades` powers of
//            ten less
//   source   none: a picture of a spectrum
//   tested   tests/glsl/test_fourier.py, against numpy.fft.fftshift
#pragma kernel(output = "magnitude:r32f")

uniform sampler2D spectrum;   //! input
uniform float decades = 5.0;  //! slider(1, 10) Powers of ten between 0 and 1

float kernel(ivec2 texel) {
    ivec2 waves = texel - (size >> 1);
    ivec2 place = waves + size * ivec2(lessThan(waves, ivec2(0)));
    vec2 found = texelFetch(spectrum, place, 0).rg;
    // The mean square of such a number is 1/3, and a spectrum sums as many as there are texels.
    float power = dot(found, found) * 3.0 / (float(size.x) * float(size.y));
    return 1.0 + 0.5 * 0.301029996 * log2(max(power, 1e-24)) / decades;
}
