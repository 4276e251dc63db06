// generation/delaunay/picture/edges.glsl -- the edges of a triangulation, and marked ones.
//
//   gives    frame, colours times their cover, over an earlier frame
//   needs    generation/delaunay/picture/{drawn,parameters/points,parameters/triangles}.glsl
//   units    pixels; colours linear
//   source   Belaiche 2010, section 1.3.8, figures 1.26 to 1.28
//   tested   tests/glsl/test_delaunay.py, by the picture's own pixels
//
// A marked edge is drawn as legal or illegal by the circle beside it. Of the last insertion the
// new edges are marked, and the edges that they replaced, which are no more, are dashed.
#include "generation/delaunay/picture/drawn.glsl"
#pragma draw(mesh = "triangles", count = "8 * points + 8", output = "frame:rgba16f", \
             depth = "none", blend = "alpha", samples = 1)

#include "generation/delaunay/picture/parameters/points.glsl"
#include "generation/delaunay/picture/parameters/triangles.glsl"
uniform float line = 1.5;      //! slider(0, 8) step(0.1) group("Picture") Width of edges and
                               //! circles; 0: none
uniform vec4 ink = vec4(0.05, 0.05, 0.06, 1.0);      //! colour group("Colours") Edges and points
uniform vec4 legal = vec4(0.02, 0.33, 0.10, 1.0);    //! colour group("Colours")
    //! A marked edge that is legal, and edges of the newest point
uniform vec4 illegal = vec4(0.75, 0.03, 0.02, 1.0);  //! colour group("Colours")
    //! A marked edge that is illegal, and edges replaced by the last insertion

const int PLAIN = 0;
const int LEGAL = 1;
const int ILLEGAL = 2;
const int REPLACED = 3;
const float DASH = 5.0;

// The ends of an element's edge and what it is; no edge where it begins with -1.
ivec3 edge_of(int element) {
    const ivec3 NONE = ivec3(-1);
    if (line <= 0.0) return NONE;
    int halves = 6 * points + 6;
    if (element < halves) {
        if (element >= 3 * triangles_of(last)) return NONE;
        ivec4 edge = edge_of_triangle(triangles, neighbours, element);
        // Two triangles share an edge: the first of them draws it.
        if (edge.w >= 0 && edge.w < element / 3) return NONE;
        int newest = int(entry(last, 0).x);
        bool is_new = marked == LAST_INSERTION && (edge.x == newest || edge.y == newest);
        return ivec3(edge.xy, is_new ? LEGAL : PLAIN);
    }
    int mark = element - halves;
    if (marked == LAST_INSERTION) {
        if (mark >= int(entry(last, 0).z)) return NONE;
        return ivec3(ivec2(entry(last, mark + 2).xy), REPLACED);
    }
    ivec4 edge = marked_edge(triangles, neighbours, last, marked, number);
    if (mark > 0 || edge.x < 0) return NONE;
    if (edge.w < 0) return ivec3(edge.xy, LEGAL);
    bool inside = is_inside_circle(entry(places, edge.x).xy, entry(places, edge.y).xy,
                                   entry(places, edge.z).xy, entry(places, edge.w).xy);
    return ivec3(edge.xy, inside ? ILLEGAL : LEGAL);
}

vec2 pixel_of(int point) {
    return pixel_of_place(entry(places, point).xy, lattice_sides(places), size, window, margin);
}

float half_width(int kind) {
    return kind == PLAIN ? 0.5 * line : line;
}

vec4 vertex(vec3 corner, out int element) {
    element = int(corner.x);
    ivec3 edge = edge_of(element);
    if (edge.x < 0) return vec4(0.0);
    vec2 from = pixel_of(edge.x);
    vec2 to = pixel_of(edge.y);
    vec2 along = (to - from) / max(distance(from, to), 1e-6);
    float around = half_width(edge.z) + 1.0;
    vec2 offset = covering(corner.y) * vec2(0.5 * distance(from, to) + around, around);
    vec2 pixel = 0.5 * (from + to) + along * offset.x + vec2(-along.y, along.x) * offset.y;
    return clip_of_pixel(pixel, size);
}

vec4 fragment(int element) {
    ivec3 edge = edge_of(element);
    vec2 from = pixel_of(edge.x);
    vec2 to = pixel_of(edge.y);
    float far = max(distance(from, to), 1e-6);
    vec2 along = (to - from) / far;
    float place = dot(gl_FragCoord.xy - from, along);
    float off = distance(gl_FragCoord.xy, from + along * clamp(place, 0.0, far));
    vec4 colour = edge.z == PLAIN ? ink : edge.z == LEGAL ? legal : illegal;
    float cover = clamp(half_width(edge.z) + 0.5 - off, 0.0, 1.0);
    float from_gap = 0.5 * DASH - abs(mod(place, 2.0 * DASH) - DASH);
    if (edge.z == REPLACED) cover *= clamp(from_gap + 0.5, 0.0, 1.0);
    return vec4(colour.rgb, colour.a * cover);
}
