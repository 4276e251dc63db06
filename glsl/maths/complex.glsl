// maths/complex.glsl -- complex numbers as pairs: products, conjugates, and the roots of one.
//
//   gives    complex_product, conjugate, root_of_one
//   needs    nothing: pure functions, no uniforms, no textures
//   units    real part in x, imaginary part in y
//   source   Taylor series of sine and cosine of 2 pi r, r in turns; derived here
//   tested   tests/glsl/test_fourier.py, against complex128 in NumPy
#ifndef MATHS_COMPLEX
#define MATHS_COMPLEX

vec2 complex_product(vec2 a, vec2 b) {
    return vec2(a.x * b.x - a.y * b.y, a.x * b.y + a.y * b.x);
}

vec2 conjugate(vec2 a) {
    return vec2(a.x, -a.y);
}

// exp(2 pi i k / count) for 0 <= k <= count, a power of two up to 2^24. Each part is off by
// 1e-7 at most, and what a quarter turn or a mirror makes alike is alike to the last bit.
//
// Drivers promise little of their own sine. Whole quarters are taken off first, which is
// exact, since k / count is; what is left is an eighth of a turn at most, either way.
vec2 root_of_one(int k, int count) {
    float turns = float(k) / float(count);
    float quarters = floor(4.0 * turns + 0.5);
    float r = turns - 0.25 * quarters;
    float s = r * r;
    // (2 pi)^n / n!, the first as a float and what that float lacks.
    float high_c = -85.4568172 + s * (60.2446414 - 26.4262568 * s);
    float high_n = -76.7058598 + s * (42.0586939 - 15.0946426 * s);
    float c = 1.0 + s * (-19.7392088 + s * (64.9393940 + s * high_c));
    float rest = s * (-41.3417023 + s * (81.6052493 + s * high_n));
    float n = r * 6.28318548 + r * (rest - 1.74845553e-7);
    int quarter = int(quarters) & 3;
    vec2 turned = (quarter & 1) == 0 ? vec2(c, n) : vec2(-n, c);
    return quarter < 2 ? turned : -turned;
}
#endif
