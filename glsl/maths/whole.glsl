// maths/whole.glsl -- exact division of whole numbers, without a slow integer division.
//
//   gives    quotient
//   needs    nothing: pure functions, no uniforms, no textures
//   units    whole numbers
//   source   derived here: a float's quotient is off by less than one, and one comparison mends it
//   tested   tests/glsl/test_maths.py, against Python's //
#ifndef MATHS_WHOLE
#define MATHS_WHOLE

// floor(a / b) for a >= 0, b > 0 and a quotient below 2^21.
int quotient(int a, int b) {
    // Three roundings of 2^-24 and a division good to 2^-22 move a quotient below 2^21 by less
    // than 1.
    int near = int(float(a) / float(b));
    int rest = a - near * b;
    return near + int(rest >= b) - int(rest < 0);
}
#endif
