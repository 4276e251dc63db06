// generation/deterministic_fractal/label.glsl -- copies, scale and dimension, in small letters.
//
//   gives    LABEL, dimension_of, is_label
//   needs    nothing: pure functions, no uniforms, no textures
//   units    pixels of the letters, from the label's lower left corner
//   source   D = log n / log(1/r), Belaiche 2010, section 1.2.1; letters of 3 x 5: drawn here
//   tested   tests/glsl/test_deterministic_fractal.py, which reads the label
#ifndef GENERATION_DETERMINISTIC_FRACTAL_LABEL
#define GENERATION_DETERMINISTIC_FRACTAL_LABEL

// Of "n=4 r=1/3 D=1.262", 17 letters with a pixel between them.
const ivec2 LABEL = ivec2(67, 5);

// A row of a letter is an octal digit, the top row first. From 10 on: n r D / . = and a space.
const int LETTERS[17] = int[17](
    075557, 026227, 071747, 071717, 055711, 074717, 074757, 071222, 075757, 075717,
    000655, 000344, 065556, 011244, 000002, 007070, 0);

// Of n copies at the scale 1/part.
float dimension_of(int copies, int part) {
    return log(float(copies)) / log(float(part));
}

int letter_of(int place, int copies, int part) {
    int thousandths = int(dimension_of(copies, part) * 1000.0 + 0.5);
    int text[17] = int[17](10, 15, copies, 16, 11, 15, 1, 13, part, 16, 12, 15, 0, 14, 0, 0, 0);
    text[12] = thousandths / 1000;
    text[14] = thousandths / 100 % 10;
    text[15] = thousandths / 10 % 10;
    text[16] = thousandths % 10;
    return LETTERS[text[place]];
}

bool is_label(ivec2 pixel, int copies, int part) {
    if (any(lessThan(pixel, ivec2(0))) || any(greaterThanEqual(pixel, LABEL))) return false;
    int column = pixel.x & 3;
    int rows = letter_of(pixel.x >> 2, copies, part);
    return column < 3 && ((rows >> (3 * pixel.y + 2 - column)) & 1) == 1;
}
#endif
