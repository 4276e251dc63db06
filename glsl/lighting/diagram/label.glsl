// lighting/diagram/label.glsl -- where a label is, and the character under a pixel.
//
//   gives    Label, label_on_left, label_on_right, label_around, board_cover, cell_of
//   needs    lighting/diagram/ink.glsl, lighting/diagram/letters.glsl
//   units    pixels; `unit` is how many a unit of the letters has
//   source   none: arithmetic
//   tested   tests/glsl/test_diagrams.py, which reads what pictures say
#ifndef LIGHTING_DIAGRAM_LABEL
#define LIGHTING_DIAGRAM_LABEL
#include "lighting/diagram/ink.glsl"
#include "lighting/diagram/letters.glsl"

struct Label {
    vec2 corner;  // lower left
    int characters;
    float unit;
};

Label label_on_left(vec2 corner, int characters, float unit) {
    return Label(floor(corner), characters, unit);
}
// The lower right corner is given, or the middle of the lower side.
Label label_on_right(vec2 corner, int characters, float unit) {
    return Label(floor(corner - vec2(float(characters) * LETTER.x * unit, 0.0)), characters, unit);
}
Label label_around(vec2 foot, int characters, float unit) {
    return Label(floor(foot - vec2(0.5 * float(characters) * LETTER.x * unit, 0.0)), characters,
                 unit);
}

// How much of a pixel the board behind the letters covers, which is a unit larger than they are.
float board_cover(Label label, vec2 place) {
    vec2 half_board = 0.5 * vec2(float(label.characters) * LETTER.x + 2.0, LETTER.y + 2.0)
            * label.unit;
    vec2 middle = label.corner
            + 0.5 * vec2(float(label.characters) * LETTER.x, LETTER.y) * label.unit;
    vec2 inside = half_board - abs(place - middle);
    return label.characters > 0 ? covered(min(inside.x, inside.y)) : 0.0;
}

// The number of a pixel's character, and where it is in that character's room; a number below 0 is
// none.
vec3 cell_of(Label label, vec2 place) {
    vec2 at = (place - label.corner) / label.unit;
    float cell = floor(at.x / LETTER.x);
    bool outside = cell < 0.0 || cell >= float(label.characters) || at.y < -1.0
            || at.y > LETTER.y + 1.0;
    // The strokes are in the middle of their space.
    return vec3(outside ? -1.0 : cell, at.x - cell * LETTER.x - 1.0, at.y);
}
#endif
