// generation/fbm/curve.glsl -- fractional Brownian motion along a line, one a row.
//
//   gives    height: of one variable, a row for each curve
//   needs    noise/gradient.glsl, noise/lattice.glsl, noise/octaves.glsl
//   units    heights in standard deviations of the whole curve, about -3..3
//   source   Belaiche 2010, section 1.2.1, after Mandelbrot and Van Ness 1968; as a sum of octaves
//            after Musgrave, in Ebert and others 2003, "Texturing and Modeling", chapter 16
//   tested   tests/glsl/test_gradient_noise.py: a NumPy twin, and the power spectrum falls as
//            f^-(2H + 1)
//
// Each octave is gradient noise of one variable: through every whole number a line of random
// slope, blended by the quintic fade. Octaves fade at two texels a cell as in the plane.
#include "noise/octaves.glsl"
#pragma kernel(output = "height:r32f")

uniform vec4 hurst = vec4(0.8, 0.6, 0.4, 0.3);  //! slider(0, 1) step(0.01)
    //! label("Hurst exponents") parts("first", "second", "third", "fourth") Of the first four rows
uniform float hurst_last = 0.2;                 //! slider(0, 1) step(0.01)
    //! label("Other exponents") Of all other rows
uniform int octaves = 10;                       //! slider(0, 16) Sums of noise; those too fine for
    //! the texels are left out
uniform float frequency = 4.0;                  //! log_slider(0.25, 1024) Cells along the row in
    //! the first octave
uniform uint seed = 7u;                         //! slider(0, 9999) Which curves

const uint SALT = 0xe23d26d9u;  // CRC-32 of "generation/fbm/curve"

// The noise's standard deviation, sqrt(2/3 integral of (1 - fade(t))^2 t^2).
const float DEVIATION = 0.140695;

// Noise of one variable; each line of it has random slopes of its own.
float noise_along(float place, int line, uint which) {
    float cell = floor(place);
    float part = place - cell;
    // Upper bits as a number in [-1, 1).
    uvec2 bits = lattice_columns(int(cell), which) * lattice_rows(line, which).x;
    vec2 slopes = vec2(ivec2(bits)) / 2147483648.0;
    vec2 planes = slopes * (part - vec2(0.0, 1.0));
    return planes.x + (planes.y - planes.x) * quintic(part);
}

float kernel(ivec2 texel) {
    float nodes = float(max(size.x - 1, 1));
    float cells = min(frequency, 0.5 * nodes);
    float falling = exp2(-(texel.y < 4 ? hurst[min(texel.y, 3)] : hurst_last));
    float total = 0.0;
    float squares = 0.0;
    float strength = 1.0;
    for (int k = 0; k < octaves && cells < nodes; k++) {
        float weight = strength * octave_weight(nodes / cells);
        float place = float(texel.x) * (cells / nodes) + OCTAVE_SHIFT.x;
        total += weight * noise_along(place, texel.y, lattice_seed(seed + SALT, k));
        squares += weight * weight;
        cells *= 2.0;
        strength *= falling;
    }
    return squares > 0.0 ? total / (DEVIATION * sqrt(squares)) : 0.0;
}
