// generation/fourier/transform.glsl -- the Fourier transform, one level of butterflies a step.
//
//   gives    transformed: a complex number for each texel, its real part in red
//   needs    maths/complex.glsl; `initial`, the numbers to transform, whose green is imaginary
//   units    as the numbers; forward they are summed, backward averaged
//   source   Belaiche 2010, section 1.3.3, steps 2 and 4; Stockham's order, as in C. Van Loan
//            1992, "Computational Frameworks for the Fast Fourier Transform", section 1.7
//   tested   tests/glsl/test_fourier.py, against scipy.fft
//
// A transform of 2h numbers is made of two of h numbers: those at even places, and those at odd
// places, which are turned by w. Over n numbers, at step t of an axis, with h = 2^t:
//
//     new[j] = old[i] + w old[i + n/2],   w = exp(-2 pi i (j mod 2h) / 2h)
//
// with i = (j div 2h) h + j mod h; backward with +2 pi, and halved. The first log2(size.x) steps
// go along x, the others along y. The result is in order: texel 0 of an axis is the mean, texel 1
// one wave, and those above size / 2 are negative frequencies, texel size - 1 being -1.
#include "maths/complex.glsl"
#pragma kernel(output = "transformed:rg32f", \
               repeat = "log2(size.x) + log2(size.y)", accepts = "2**n, 2**m")

uniform int direction = 0; //! menu("forward", "backward") From heights to frequencies, or back

vec2 kernel(ivec2 texel) {
    int steps_along_x = int(log2(float(size.x)) + 0.5);
    bool along_x = iteration < steps_along_x;
    int t = along_x ? iteration : iteration - steps_along_x;
    int n = along_x ? size.x : size.y;
    int h = 1 << t;
    int j = along_x ? texel.x : texel.y;
    int i = j / (2 * h) * h + j % h;
    ivec2 here = along_x ? ivec2(i, texel.y) : ivec2(texel.x, i);
    ivec2 further = along_x ? ivec2(n / 2, 0) : ivec2(0, n / 2);
    // anchor: butterfly
    vec2 w = root_of_one(j % (2 * h), 2 * h);
    if (direction == 0) w = conjugate(w);
    vec2 sum = previous(here) + complex_product(w, previous(here + further));
    return direction == 0 ? sum : 0.5 * sum;
    // end: butterfly
}
