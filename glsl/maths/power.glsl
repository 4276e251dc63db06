// maths/power.glsl -- powers of numbers above 0, the same on every driver.
//
//   gives    power
//   needs    nothing: pure functions, no uniforms, no textures
//   units    none
//   source   series of the inverse hyperbolic tangent and of 2^x; derived here
//   tested   tests/glsl/test_fourier.py, against float64 in NumPy
//
// Drivers' own pow, exp2 and log2 differ in their last digits, and llvmpipe's take four times
// as long. x = 2^e m with m between the roots of 1/2 and 2, and log2 m is a series in
// (m - 1) / (m + 1). The whole part of y e is kept apart, for it would cost the rest digits.
#ifndef MATHS_POWER
#define MATHS_POWER

// x^y, off by 2e-6 of it at most, for x from 2^-60 to 2^60 and a result in the same range.
float power(float x, float y) {
    int bits = floatBitsToInt(x);
    int e = (bits - 0x3f3504f3) >> 23;
    float m = intBitsToFloat(bits - (e << 23));
    float t = (m - 1.0) / (m + 1.0);
    float s = t * t;
    // 2 / ln 2 / (1, 3, 5, ..)
    float high = 0.577078016 + s * (0.412198583 + s * 0.320598898);
    float log_m = t * (2.88539008 + s * (0.961796694 + s * high));
    float z = y * float(e);
    float whole = floor(z + 0.5);
    float rest = (z - whole) + y * log_m;
    float more = floor(rest + 0.5);
    float g = rest - more;
    // (ln 2)^n / n!
    float h = 0.0555041087 + g * (0.00961812911 + g * (0.00133335581 + g * 0.000154035304));
    float root = 1.0 + g * (0.693147181 + g * (0.240226507 + g * h));
    return root * intBitsToFloat((int(whole + more) + 127) << 23);
}
#endif
