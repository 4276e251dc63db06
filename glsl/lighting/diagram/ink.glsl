// lighting/diagram/ink.glsl -- how much of a pixel lines, dots, arcs and arrows cover.
//
//   gives    covered, dot_cover, line_distance, line_cover, dash_cover, half_plane, turned_from,
//            arc_cover, sector_cover, arrow_cover
//   needs    nothing: pure functions, no uniforms, no textures
//   units    pixels; angles in radians, anticlockwise from the right
//   source   made here: a pixel is covered by how far its middle is from a shape's edge
//   tested   tests/glsl/test_diagrams.py, against shapes in NumPy and by colours in the pictures
#ifndef LIGHTING_DIAGRAM_INK
#define LIGHTING_DIAGRAM_INK

// A shape whose edge is `inside` pixels away; negative outside.
float covered(float inside) {
    return clamp(inside + 0.5, 0.0, 1.0);
}

float dot_cover(vec2 place, vec2 middle, float radius) {
    return covered(radius - length(place - middle));
}

float line_distance(vec2 place, vec2 from, vec2 to) {
    vec2 along = to - from;
    float share = clamp(dot(place - from, along) / max(dot(along, along), 1e-12), 0.0, 1.0);
    return length(place - from - share * along);
}

float line_cover(vec2 place, vec2 from, vec2 to, float width) {
    return covered(0.5 * width - line_distance(place, from, to));
}

// A line whose dashes are `dash` long and as far apart.
float dash_cover(vec2 place, vec2 from, vec2 to, float width, float dash) {
    vec2 along = (to - from) / max(length(to - from), 1e-6);
    float part = fract(dot(place - from, along) / (2.0 * dash)) * 2.0 * dash;
    return line_cover(place, from, to, width) * covered(0.5 * dash - abs(part - 0.5 * dash));
}

// The side of a line through a place that lies to the left of its way.
float half_plane(vec2 place, vec2 through, vec2 direction) {
    vec2 along = direction / max(length(direction), 1e-6);
    vec2 offset = place - through;
    return covered(along.x * offset.y - along.y * offset.x);
}

// The angle of a way, from that of another: above -pi, up to pi.
float turned_from(vec2 direction, vec2 zero) {
    float ahead = dot(zero, direction);
    float aside = zero.x * direction.y - zero.y * direction.x;
    // Of no way at all there is no arc tangent.
    return atan(aside, ahead == 0.0 && aside == 0.0 ? 1.0 : ahead);
}

// The part of a circle from one angle to a greater one.
float arc_cover(vec2 place, vec2 middle, float radius, float from, float to, float width) {
    vec2 offset = place - middle;
    float bisector = 0.5 * (from + to);
    float off = abs(turned_from(offset, vec2(cos(bisector), sin(bisector)))) - 0.5 * (to - from);
    return covered(0.5 * width - abs(length(offset) - radius)) * covered(-off * radius);
}

// The disc's part between these angles.
float sector_cover(vec2 place, vec2 middle, float radius, float from, float to) {
    vec2 offset = place - middle;
    float bisector = 0.5 * (from + to);
    float off = abs(turned_from(offset, vec2(cos(bisector), sin(bisector)))) - 0.5 * (to - from);
    return covered(radius - length(offset)) * covered(-off * length(offset));
}

// A line with a head of `head` at its end.
float arrow_cover(vec2 place, vec2 from, vec2 to, float width, float head) {
    vec2 along = (to - from) / max(length(to - from), 1e-6);
    vec2 offset = to - place;
    float behind = dot(offset, along);
    float aside = abs(along.x * offset.y - along.y * offset.x);
    // The head is three times as long as half of it is wide.
    float inside = min((behind / 3.0 - aside) * 0.94868, head - behind);
    return max(line_cover(place, from, to - 0.5 * head * along, width), covered(inside));
}
#endif
