// generation/delaunay/picture/drawn.glsl -- where a triangulation is in a picture, and its marks.
//
//   gives    pixel_of_place, clip_of_pixel, covering, triangles_of, is_inside_circle,
//            edge_of_triangle, marked_edge, marked_triangle and the names of what may be marked
//   needs    generation/delaunay/tables.glsl
//   units    pixels of the picture, whose first is 0 to 1; lattice spacings
//   source   derived here; the circle's determinant as in playground/data/delaunay.py
//   tested   tests/glsl/test_delaunay.py, by the pictures' own pixels
#ifndef GENERATION_DELAUNAY_PICTURE_DRAWN
#define GENERATION_DELAUNAY_PICTURE_DRAWN
#include "generation/delaunay/tables.glsl"

// The choices of `marked`.
const int AN_EDGE = 1;
const int A_FLIP = 2;
const int LAST_INSERTION = 3;

// Lattice spacings to a pixel: the terrain as large as fits the window but for its margin, its
// shape kept.
float lattice_per_pixel(ivec2 sides, ivec2 picture, vec4 window, float margin) {
    vec2 room = (window.zw - window.xy) * vec2(picture) * (1.0 - 2.0 * margin);
    vec2 wanted = vec2(sides) / max(room, vec2(1e-3));
    return max(wanted.x, wanted.y);
}

// The pixel of a place on the terrain, which is in the middle of its window.
vec2 pixel_of_place(vec2 place, ivec2 sides, ivec2 picture, vec4 window, float margin) {
    vec2 middle = 0.5 * (window.xy + window.zw) * vec2(picture);
    vec2 offset = place - 0.5 * vec2(sides);
    return middle + offset / lattice_per_pixel(sides, picture, window, margin);
}

vec4 clip_of_pixel(vec2 pixel, ivec2 picture) {
    return vec4(pixel / vec2(picture) * 2.0 - 1.0, 0.0, 1.0);
}

// A corner of the triangle that covers the square from -1 to 1.
vec2 covering(float corner) {
    return corner < 0.5 ? vec2(-1.0, -1.0) : corner < 1.5 ? vec2(3.0, -1.0) : vec2(-1.0, 3.0);
}

int triangles_of(sampler2D last) {
    return int(entry(last, 0).w);
}

// Whether the circle through a, b and c, counter-clockwise, holds d: in floats, for pictures.
// anchor: inside
bool is_inside_circle(vec2 a, vec2 b, vec2 c, vec2 d) {
    float unit = 1.0 / max(max(distance(a, d), distance(b, d)), max(distance(c, d), 1e-9));
    a = (a - d) * unit;
    b = (b - d) * unit;
    c = (c - d) * unit;
    float inside = dot(a, a) * (b.x * c.y - c.x * b.y)
                 + dot(b, b) * (c.x * a.y - a.x * c.y)
                 + dot(c, c) * (a.x * b.y - b.x * a.y);
    return inside > 1e-6;
}
// end: inside

// The corner of a triangle that is neither u nor v.
int third(ivec3 triangle, int u, int v) {
    if (triangle.x != u && triangle.x != v) return triangle.x;
    return triangle.y != u && triangle.y != v ? triangle.y : triangle.z;
}

// An edge by its number, three to a triangle: its ends, the corner across from it, and the
// triangle beyond it, -1 where there is none.
ivec4 edge_of_triangle(sampler2D triangles, sampler2D neighbours, int number) {
    int triangle = number / 3;
    int place = number - 3 * triangle;
    ivec3 c = ivec3(entry(triangles, triangle).xyz);
    ivec3 n = ivec3(entry(neighbours, triangle).xyz);
    if (place == 0) return ivec4(c.yzx, n.x);
    return place == 1 ? ivec4(c.zxy, n.y) : ivec4(c, n.z);
}

// The marked edge u v and the points across from it, on its left and on its right: -1 where there
// is none. A flip is numbered by its order.
ivec4 marked_edge(sampler2D triangles, sampler2D neighbours, sampler2D last,
                  int marked, int number) {
    const ivec4 NONE = ivec4(-1);
    if (marked == AN_EDGE) {
        if (number >= 3 * triangles_of(last)) return NONE;
        ivec4 edge = edge_of_triangle(triangles, neighbours, number);
        if (edge.w < 0) return edge;
        return ivec4(edge.xyz, third(ivec3(entry(triangles, edge.w).xyz), edge.x, edge.y));
    }
    ivec4 head = ivec4(entry(last, 0));
    if (marked != A_FLIP || number + 2 > head.y) return NONE;
    ivec3 flipped = ivec3(entry(last, number + 2).xyz);
    // Before the flip the edge u v parts the new point from the one beyond; after it, an edge
    // joins them.
    if (number >= head.z) return ivec4(flipped.xy, head.x, flipped.z);
    ivec4 edge = ivec4(head.x, flipped.z, flipped.y, flipped.x);
    // Later flips may have put nearer points beside it.
    for (int later = number + 1; later < head.z; later++) {
        ivec3 next = ivec3(entry(last, later + 2).xyz);
        if (next.xy == edge.yz) edge.z = next.z;
        if (next.xy == edge.wy) edge.w = next.z;
    }
    return edge;
}

// Marked triangle k: those beside the marked edge, or those that the last insertion destroyed; -1
// where there is none.
ivec3 marked_triangle(sampler2D triangles, sampler2D neighbours, sampler2D last,
                      int marked, int number, int k) {
    if (marked == LAST_INSERTION) {
        return k < int(entry(last, 0).y) ? ivec3(entry(last, k + 1).xyz) : ivec3(-1);
    }
    ivec4 edge = marked_edge(triangles, neighbours, last, marked, number);
    ivec3 neighbour = k == 0 ? edge.xyz : edge.yxw;
    return k > 1 || min(neighbour.x, neighbour.z) < 0 ? ivec3(-1) : neighbour;
}
#endif
