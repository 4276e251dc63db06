// generation/deterministic_fractal.glsl -- sets made of n copies of themselves at the scale r.
//
//   gives    colour: a drawing of the set; set_distance: how far it is, 0 on it
//   needs    generation/deterministic_fractal/{folds,label}.glsl, maths/whole.glsl
//   units    colours linear; distances in widths of the set
//   source   Belaiche 2010, section 1.2.1 and figure 1.1
//   tested   tests/glsl/test_deterministic_fractal.py: distances to every piece, and the
//            dimension by counting boxes
//
// The thesis does not say which sets its figure shows; these are chosen here, in the order of
// their dimension D = log n / log(1/r). Two with the same D look nothing alike.
#include "generation/deterministic_fractal/folds.glsl"
#include "generation/deterministic_fractal/label.glsl"
#include "maths/whole.glsl"
#pragma kernel(output = "colour:rgba16f, set_distance:r32f")

uniform int fractal = 0;   //!
                           //! menu("all", "Cantor set", "Koch curve", "Cantor dust",
                           //! "Vicsek cross", "Sierpinski triangle", "Sierpinski carpet") Which
                           //! set, or all side by side
uniform int depth = 5;     //! slider(0, 8) How many times each piece has made way for smaller
                           //! copies
uniform float pen = 0.5;   //! slider(0, 4) step(0.1) unit("px") How far around the set ink
                           //! reaches: pieces finer than a pixel stay visible
uniform float margin = 0.06;  //! slider(0, 0.4) step(0.01) Empty border, as a share of the panel
uniform bool label = true;    //! Write the copies n, their scale r and the dimension D underneath
uniform vec3 ink = vec3(0.012, 0.03, 0.07);      //! colour Colour of the set
uniform vec3 paper = vec3(0.86, 0.84, 0.78);     //! colour Colour of the ground

void kernel(ivec2 texel, out vec4 colour, out float set_distance) {
    ivec2 panels = fractal == 0 ? ivec2(3, 2) : ivec2(1);
    ivec2 along = texel * panels;
    ivec2 panel = ivec2(quotient(along.x, size.x), quotient(along.y, size.y));
    int set = fractal == 0 ? panel.x + 3 * (1 - panel.y) : fractal - 1;
    vec2 room = vec2(size) / vec2(panels);
    vec2 inside = vec2(texel) + 0.5 - vec2(panel) * room;

    // Letters of one to four pixels; below them and above as much room as they are high.
    float letter = clamp(floor(min(room.x / 90.0, room.y / 60.0)), 1.0, 4.0);
    float strip = label ? 3.0 * letter * float(LABEL.y) : 0.0;
    float side = max(min(room.x, room.y - strip) * (1.0 - 2.0 * margin), 1.0);
    vec2 place = (inside - 0.5 * vec2(room.x, room.y + strip)) / side;
    set_distance = set == CANTOR_SET ? cantor_bars(place, depth)
                                     : distance_to_set(set, place, depth);
    float shown = clamp(pen + 0.5 - set_distance * side, 0.0, 1.0);
    if (label) {
        vec2 letters = inside - 0.5 * vec2(room.x, strip) + 0.5 * letter * vec2(LABEL);
        ivec2 copies = copies_of(set);
        if (is_label(ivec2(floor(letters / letter)), copies.x, copies.y)) shown = 1.0;
    }
    colour = vec4(mix(paper, ink, shown), 1.0);
}
