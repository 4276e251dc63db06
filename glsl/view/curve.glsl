// view/curve.glsl -- rows of heights as curves, above each other or one over the other.
//
//   gives    frame, display-encoded
//   needs    colour/encode.glsl, maths/number.glsl; a texture whose rows are curves
//   units    heights as they are, lowest and highest in the same; widths in pixels
//   source   none: a picture of numbers. A pixel is covered by how far it is from the curve
//   tested   tests/glsl/test_curve_view.py, by where curves and axes must be in the picture
//
// Texel k of n is at k / (n - 1) of the picture's width. Curves above each other are in
// panels of the same height, the first row on top; the lowest number is at a panel's foot.
#include "colour/encode.glsl"
#include "maths/number.glsl"
#pragma kernel(output = "frame:rgba8")

uniform sampler2D height;             //! input
uniform int arranged = 0;             //! menu("stacked", "overlaid")
                                      //! A panel for each row, or all rows in one
uniform int rows = 0;                 //! slider(0, 32) Rows shown, from the first on; 0: all
uniform float width = 1.5;            //! slider(0.5, 12) step(0.1) unit("pixels") Of the line
uniform float lowest = 0.0;           //! slider(-4, 4) step(0.01) group("Range")
                                      //! The number at a panel's foot
uniform float highest = 1.0;          //! slider(-4, 4) step(0.01) group("Range")
                                      //! The number at its top
uniform float margin = 0.06;          //! slider(0, 0.4) step(0.01) group("Range")
                                      //! Left free at a panel's foot and top, over its height
uniform vec3 line = vec3(0.02, 0.10, 0.32);   //! colour group("Colours") The first curve
uniform vec3 line_last = vec3(0.45, 0.10, 0.03);  //! colour group("Colours")
                                                  //! The last curve; those between are mixed
uniform vec3 ground = vec3(1.0);              //! colour group("Colours") Behind the curves
uniform bool axis = true;             //! group("Axis") A line across each panel
uniform float baseline = 0.0;         //! slider(-4, 4) step(0.01) group("Axis")
                                      //! The number it is at
uniform vec3 axis_colour = vec3(0.55);  //! colour group("Axis") Its colour

float distance_to_segment(vec2 place, vec2 from, vec2 to) {
    vec2 along = to - from;
    float share = clamp(dot(place - from, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
    return length(place - from - share * along);
}

// How much of a pixel a line covers, from its middle's distance in pixels.
float cover(float far, float wide) {
    return clamp(0.5 * wide + 0.5 - far, 0.0, 1.0) * min(wide, 1.0);
}

vec4 kernel(ivec2 texel) {
    ivec2 found = textureSize(height, 0);
    int shown = rows > 0 ? min(rows, found.y) : found.y;
    int panels = arranged == 0 ? shown : 1;
    float panel_height = float(size.y) / float(panels);
    vec2 place = vec2(texel) + 0.5;
    // From the top: the picture's row 0 is its lowest.
    int panel = clamp(int((float(size.y) - place.y) / panel_height), 0, panels - 1);
    float foot = float(size.y) - float(panel + 1) * panel_height + margin * panel_height;
    float span = highest - lowest;
    float rise = (1.0 - 2.0 * margin) * panel_height / (abs(span) < 1e-20 ? 1e-20 : span);
    // Pixels from one texel of a row to the next; a single texel is drawn from edge to edge.
    float pitch = float(size.x) / float(max(found.x - 1, 1));
    float reach = 0.5 * width + 1.0;
    int first = int(floor((place.x - reach) / pitch));
    int last = int(ceil((place.x + reach) / pitch));
    vec3 seen = ground;
    if (axis) {
        seen = mix(seen, axis_colour, cover(abs(place.y - (foot + (baseline - lowest) * rise)),
                                            1.0));
    }
    bool broken = false;
    int row_first = arranged == 0 ? panel : 0;
    int row_last = arranged == 0 ? panel : shown - 1;
    for (int row = row_first; row <= row_last; row++) {
        float nearest = 1e9;
        vec2 from = vec2(0.0);
        bool linked = false;
        for (int k = first; k <= last; k++) {
            float value = texelFetch(height, ivec2(clamp(k, 0, found.x - 1), row), 0).r;
            vec2 to = vec2(float(k) * pitch, clamp(foot + (value - lowest) * rise, -1e5, 1e5));
            bool number = is_number(value);
            if (linked && number) nearest = min(nearest, distance_to_segment(place, from, to));
            broken = broken || (!number && k >= 0 && k < found.x
                                && abs(to.x - place.x) <= max(0.5 * pitch, 0.5));
            from = to;
            linked = number;
        }
        float share = shown > 1 ? float(row) / float(shown - 1) : 0.0;
        seen = mix(seen, mix(line, line_last, share), cover(nearest, width));
    }
    return vec4(broken ? NOT_A_NUMBER : srgb_from_linear(seen), 1.0);
}
