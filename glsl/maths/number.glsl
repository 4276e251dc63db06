// maths/number.glsl -- what is not a number, and the colour in which it is shown.
//
//   gives    is_number, NOT_A_NUMBER
//   needs    nothing: pure functions, no uniforms, no textures
//   units    colours of light, or encoded: it is the same in both
//   source   none: a colour that no ramp and no terrain has
//   tested   tests/glsl/test_maths.py; in pictures by tests/glsl/test_view.py
#ifndef MATHS_NUMBER
#define MATHS_NUMBER
const vec3 NOT_A_NUMBER = vec3(1.0, 0.0, 1.0);

bool is_number(float value) {
    return !isnan(value) && !isinf(value);
}
#endif
