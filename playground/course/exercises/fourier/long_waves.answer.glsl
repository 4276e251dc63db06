// generation/fourier/filter.glsl -- a spectrum with each frequency f weighed by 1 / f^r.
//
//   gives    filtered: a complex number for each frequency
//   needs    maths/power.glsl
//   units    as the spectrum; frequencies in waves per terrain, along its longer side
//   source   Belaiche 2010, section 1.3.3, step 3, after Fournier, Fussell and Carpenter 1982
//   tested   tests/glsl/test_fourier.py, against NumPy
//
// f is the length of (fx, fy), both signed: at the far end of a spectrum are slow waves
// with a minus sign, not the fastest ones. Frequency 0, the mean, is left alone. The fractal's
// H is r - 1, and its power falls as f^(-2 r).
#include "maths/power.glsl"
#pragma kernel(output = "filtered:rg32f")

uniform sampler2D spectrum;     //! input
uniform float roughness = 2.0;  //! slider(0, 4) step(0.01) The r of 1 / f^r: 0 is noise, the
                                //! higher the smoother

vec2 kernel(ivec2 texel) {
    ivec2 waves = texel - size * ivec2(greaterThan(2 * texel, size));
    vec2 f = vec2(waves * max(size.x, size.y)) / vec2(size);
    float squared = dot(f, f);
    float weight = squared > 0.0 ? power(squared, -0.5 * roughness) : 1.0;
    if (squared > 64.0) weight = 0.0;
    return weight * texelFetch(spectrum, texel, 0).rg;
}
