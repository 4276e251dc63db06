// lighting/diagram/letters.glsl -- letters and numbers drawn with a round pen, smooth at any size.
//
//   gives    LETTER, letter_distance, character_of, number_character
//   needs    maths/whole.glsl
//   units    units of the letters: a capital is 9 high, one letter is LETTER.x after another
//   source   strokes drawn here
//   tested   tests/glsl/test_diagrams.py, which reads what pictures say
//
// A character is its ASCII code; 96 is the degree sign. Characters that no picture writes are
// blank.
#ifndef LIGHTING_DIAGRAM_LETTERS
#define LIGHTING_DIAGRAM_LETTERS
#include "maths/whole.glsl"

// The room of a character: strokes go from 0 to 6 across and from 0 to 13 up, the line is at 3.
const vec2 LETTER = vec2(8.0, 13.0);

// From % to z. A byte is a point, the lowest byte the first: 3 bits across, 4 up, and one that
// says whether the pen was down on the way there.
const int FIRST_CHARACTER = 37;
const uvec4 STROKES[86] = uvec4[86](
    uvec4(0xD161E618u, 0x00009D2Du, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0x94AAD26Cu, 0u, 0u, 0u),
    uvec4(0x92ACD46Au, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0xD323BE38u, 0u, 0u, 0u),
    uvec4(0x00008A1Bu, 0u, 0u, 0u),
    uvec4(0x0000BD39u, 0u, 0u, 0u),
    uvec4(0x00009B1Bu, 0u, 0u, 0u),
    uvec4(0x0000EE10u, 0u, 0u, 0u),
    uvec4(0xAED6E462u, 0xD0A89A9Cu, 0x000000E2u, 0u),
    uvec4(0x199BE351u, 0x0000009Du, 0u, 0u),
    uvec4(0xD6E4E250u, 0x009E98C6u, 0u, 0u),
    uvec4(0xC4C3E660u, 0x9A9CAEB6u, 0x000000A8u, 0u),
    uvec4(0xB6B0E51Du, 0u, 0u, 0u),
    uvec4(0xCAC0E166u, 0x9CAEBECCu, 0x0000A09Au, 0u),
    uvec4(0xA8C0E365u, 0xB6AE9C9Au, 0x00B0C2C4u, 0u),
    uvec4(0x009AE660u, 0u, 0u, 0u),
    uvec4(0xE4E2D042u, 0xB0C2C4D6u, 0xAE9C9AA8u, 0x0000C4B6u),
    uvec4(0xD6BE9B19u, 0xC8D0E2E4u, 0x00CEBCBAu, 0u),
    uvec4(0xC343A323u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0x00A5B955u, 0u, 0u, 0u),
    uvec4(0xB630CE48u, 0u, 0u, 0u),
    uvec4(0x00A1BD51u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0x9E669860u, 0x0000BE38u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0x009E9961u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0xE69EE018u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0x00E69B60u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0xDCE3E259u, 0xD1CACBD4u, 0x000000D9u, 0u),
    uvec4(0x9DC5CC49u, 0xA0A8B235u, 0x00A59B99u, 0u),
    uvec4(0xCB399961u, 0x9CAEBECCu, 0x0000A99Bu, 0u),
    uvec4(0xB8CACC46u, 0xA69C9AA8u, 0u, 0u),
    uvec4(0xCB3D9D65u, 0x9AA8B8CAu, 0x0000AD9Bu, 0u),
    uvec4(0xCCBEB630u, 0x9AA8B8CAu, 0x0000A69Cu, 0u),
    uvec4(0x9BDBE465u, 0x0000C541u, 0u, 0u),
    uvec4(0x82848D4Du, 0xCACB3D88u, 0x9B9AA8B8u, 0x000000ADu),
    uvec4(0xCB399961u, 0x009DC5CCu, 0u, 0u),
    uvec4(0x199BCB4Au, 0x00E3639Du, 0u, 0u),
    uvec4(0x838CCC4Bu, 0x00E46481u, 0u, 0u),
    uvec4(0xB14D9961u, 0x00009D3Au, 0u, 0u),
    uvec4(0x9CA3E362u, 0x0000009Du, 0u, 0u),
    uvec4(0xCA389848u, 0xCD3B9BC3u, 0x00009EC6u, 0u),
    uvec4(0xCB399949u, 0x009DC5CCu, 0u, 0u),
    uvec4(0xAEBECC4Au, 0xB8A89A9Cu, 0x000000CAu, 0u),
    uvec4(0xCB398149u, 0x9CAEBECCu, 0x0000A99Bu, 0u),
    uvec4(0xCB3D854Du, 0x9AA8B8CAu, 0x0000AD9Bu, 0u),
    uvec4(0xCB399949u, 0x000000CDu, 0u, 0u),
    uvec4(0xB9C1CA4Du, 0xA5ADB4B2u, 0x0000999Cu, 0u),
    uvec4(0x9D9BA262u, 0x0000CD48u, 0u, 0u),
    uvec4(0x9B9AA149u, 0x009D4DADu, 0u, 0u),
    uvec4(0x00CE9B48u, 0u, 0u, 0u),
    uvec4(0x9DC39948u, 0x000000CEu, 0u, 0u),
    uvec4(0x984E9E48u, 0u, 0u, 0u),
    uvec4(0x8A4E9B48u, 0x00008081u, 0u, 0u),
    uvec4(0x9E98CE48u, 0u, 0u, 0u)
);

// How far a place is from a character's strokes; far where it has none.
float letter_distance(int character, vec2 place) {
    int index = character - FIRST_CHARACTER;
    uvec4 strokes = index < 0 || index >= STROKES.length() ? uvec4(0u)
            : STROKES[clamp(index, 0, STROKES.length() - 1)];
    float nearest = 1e3;
    vec2 from = vec2(0.0);
    for (int k = 0; k < 16; k++) {
        uint point = (strokes[k >> 2] >> uint(8 * (k & 3))) & 255u;
        vec2 to = vec2(float(point & 7u), float((point >> 3u) & 15u));
        vec2 along = to - from;
        float share = clamp(dot(place - from, along) / max(dot(along, along), 1e-6), 0.0, 1.0);
        if (point >= 128u) nearest = min(nearest, length(place - from - share * along));
        from = to;
    }
    return nearest;
}

// A character of a text that has four in each number, the lowest byte the first.
int character_of(uvec4 text, int place) {
    return int((text[place >> 2] >> uint(8 * (place & 3))) & 255u);
}

// A character of a number, written with so many decimals and standing on the right of `room`
// places; its sign, if it is negative, is before its first digit.
int number_character(float value, int decimals, int place, int room) {
    float scale = decimals == 0 ? 1.0 : decimals == 1 ? 10.0 : decimals == 2 ? 100.0 : 1000.0;
    int whole = int(min(floor(abs(value) * scale + 0.5), 9999999.0));
    int digits = 1;
    for (int bound = 10; bound <= 1000000; bound *= 10) digits += int(whole >= bound);
    digits = max(digits, decimals + 1);
    int from_right = room - 1 - place;
    if (decimals > 0 && from_right == decimals) return 46;
    int power = from_right - int(decimals > 0 && from_right > decimals);
    if (power >= digits) return power == digits && value < 0.0 && whole > 0 ? 45 : 32;
    int part = whole;
    for (int k = 0; k < power; k++) part = quotient(part, 10);
    return 48 + part - 10 * quotient(part, 10);
}
#endif
