// lighting/diagram/section.glsl -- a row of heights as a drawn section of the terrain.
//
//   gives    Section, columns_shown, section_of, on_paper, node_on_paper, column_before,
//            ground_above, surface_cover
//   needs    lighting/diagram/ink.glsl; the texture comes as an argument, no uniform of its own
//   units    metres of the terrain, pixels of the picture
//   source   none: a picture of numbers
//   tested   tests/glsl/test_diagrams.py, by where heights must be in the picture
//
// Lengths along and upwards have one scale, so that angles in the picture are angles. The
// texels that are shown fill the width; the lowest of their heights is `foot` of the
// picture's height above its edge.
#ifndef LIGHTING_DIAGRAM_SECTION
#define LIGHTING_DIAGRAM_SECTION
#include "lighting/diagram/ink.glsl"

struct Section {
    int row;
    int last;       // column of the terrain
    float spacing;  // metres from a column to the next
    float relief;   // metres from height 0 to 1
    vec2 corner;    // metres along and up at the picture's lower left corner
    float scale;    // pixels a metre
};

// The first and the last column shown; a last one of 0 or less is the terrain's.
ivec2 columns_shown(int first, int last, int columns) {
    int from = clamp(first, 0, max(columns - 2, 0));
    int to = last <= 0 ? columns - 1 : min(last, columns - 1);
    return ivec2(from, max(to, from + 1));
}

Section section_of(int row, int columns, ivec2 shown, float spacing, float relief, float lowest,
                   float foot, vec2 size) {
    float scale = size.x / (float(shown.y - shown.x) * max(spacing, 1e-6));
    vec2 corner = vec2(float(shown.x) * spacing, lowest - foot * size.y / scale);
    return Section(row, columns - 1, spacing, relief, corner, scale);
}

vec2 on_paper(Section section, vec2 metres) {
    return (metres - section.corner) * section.scale;
}

vec2 node_on_paper(sampler2D height, Section section, int column) {
    int clamped = clamp(column, 0, section.last);
    float up = texelFetch(height, ivec2(clamped, section.row), 0).r * section.relief;
    return on_paper(section, vec2(float(clamped) * section.spacing, up));
}

// The column at or before a pixel.
int column_before(Section section, float along) {
    float place = (along / section.scale + section.corner.x) / max(section.spacing, 1e-6);
    return int(clamp(floor(place), 0.0, float(max(section.last - 1, 0))));
}

// How far the terrain's surface is above a pixel's middle.
float ground_above(sampler2D height, Section section, vec2 place) {
    int column = column_before(section, place.x);
    vec2 from = node_on_paper(height, section, column);
    vec2 to = node_on_paper(height, section, column + 1);
    float part = clamp((place.x - from.x) / max(to.x - from.x, 1e-6), 0.0, 1.0);
    return from.y + (to.y - from.y) * part - place.y;
}

// The surface's line, and the dots of its nodes.
vec2 surface_cover(sampler2D height, Section section, vec2 place, float width, float radius) {
    int column = column_before(section, place.x);
    // Nodes may lie closer than lines are wide: then each is still met by its own pixels.
    int reach = int(clamp((width + 1.0) / max(section.scale * section.spacing, 1e-3), 1.0, 8.0));
    float line = 1e9;
    float node = 1e9;
    vec2 from = node_on_paper(height, section, column - reach);
    for (int k = 1 - reach; k <= 1 + reach; k++) {
        vec2 to = node_on_paper(height, section, column + k);
        line = min(line, line_distance(place, from, to));
        node = min(node, length(place - to));
        from = to;
    }
    return vec2(covered(0.5 * width - line), covered(radius - node));
}
#endif
