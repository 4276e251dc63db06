// view/profile/digits.glsl -- numbers in a picture, of signs five pixels wide and seven high.
//
//   gives    SIGN_METRES, SIGN_KILO, number_width, number_at
//   needs    nothing: pure functions, no uniforms, no textures
//   units    pixels from a number's lower left corner, east and up; 1 where there is ink, else 0
//   source   made here: dots on a grid, as on the boards of railway stations
//   tested   tests/glsl/test_view_profile.py, against the signs drawn as text
//
// A sign is seven rows of five dots. The four lowest rows are one whole number, the other three
// a second; a row's western dot is its highest bit.
#ifndef VIEW_PROFILE_DIGITS
#define VIEW_PROFILE_DIGITS

const ivec2 SIGN_DOTS[14] = ivec2[14](
    ivec2(0xAE62E, 0x3A33),  // 0
    ivec2(0x2108E, 0x1184),  // 1
    ivec2(0x1111F, 0x3A21),  // 2
    ivec2(0x1062E, 0x7C44),  // 3
    ivec2(0x97C42, 0x08CA),  // 4
    ivec2(0x0862E, 0x7E1E),  // 5
    ivec2(0xF462E, 0x1910),  // 6
    ivec2(0x21084, 0x7C22),  // 7
    ivec2(0x7462E, 0x3A31),  // 8
    ivec2(0x7844C, 0x3A31),  // 9
    ivec2(0x70000, 0x0000),  // -
    ivec2(0x0018C, 0x0000),  // .
    ivec2(0xA6292, 0x4212),  // k
    ivec2(0xAD6B5, 0x001A)   // m
);
const int SIGN_MINUS = 10;
const int SIGN_POINT = 11;
const int SIGN_KILO = 12;
const int SIGN_METRES = 13;
const int SIGN_ADVANCE = 6;  // from one sign to the next

float sign_at(int which, ivec2 dot_of) {
    if (any(lessThan(dot_of, ivec2(0))) || dot_of.x > 4 || dot_of.y > 6) return 0.0;
    ivec2 dots = SIGN_DOTS[which];
    int rows = dot_of.y < 4 ? dots.x >> (5 * dot_of.y) : dots.y >> (5 * (dot_of.y - 4));
    return float((rows >> (4 - dot_of.x)) & 1);
}

// Digits of a number without its sign; with decimals, at least one before the point.
int digits_in(int number, int decimals) {
    int found = 1;
    for (int rest = abs(number) / 10; rest > 0; rest /= 10) found++;
    return max(found, decimals + 1);
}

// Pixels from a number's west to its east: `number` is its value times 10 to the power of
// `decimals`.
int number_width(int number, int decimals) {
    int signs = digits_in(number, decimals) + (number < 0 ? 1 : 0) + (decimals > 0 ? 1 : 0);
    return signs * SIGN_ADVANCE - 1;
}

float number_at(ivec2 pixel, int number, int decimals) {
    int count = digits_in(number, decimals);
    int place = pixel.x < 0 ? -1 : pixel.x / SIGN_ADVANCE;
    ivec2 dot_of = ivec2(pixel.x - place * SIGN_ADVANCE, pixel.y);
    if (number < 0) {
        if (place == 0) return sign_at(SIGN_MINUS, dot_of);
        place--;
    }
    int whole = count - decimals;  // digits before the point
    if (decimals > 0 && place == whole) return sign_at(SIGN_POINT, dot_of);
    if (decimals > 0 && place > whole) place--;
    if (place < 0 || place >= count) return 0.0;
    int rest = abs(number);
    for (int k = count - 1; k > place; k--) rest /= 10;
    return sign_at(rest % 10, dot_of);
}
#endif
