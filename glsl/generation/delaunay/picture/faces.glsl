// generation/delaunay/picture/faces.glsl -- marked triangles, filled: those beside an edge, or those destroyed.
//
//   gives    frame, colours times their cover, over an earlier frame
//   needs    generation/delaunay/picture/drawn.glsl
//   units    pixels; colours linear
//   source   Belaiche 2010, section 1.3.8, figures 1.27 and 1.28
//   tested   tests/glsl/test_delaunay.py, by the picture's own pixels
#include "generation/delaunay/picture/drawn.glsl"
#pragma draw(mesh = "triangles", count = "2 * points + 2", output = "frame:rgba16f", depth = "none", blend = "alpha", samples = 1)

uniform sampler2D places;      //! input
uniform sampler2D triangles;   //! input
uniform sampler2D neighbours;  //! input
uniform sampler2D last;        //! input
uniform int points = 1000;     //! slider(0, 10000) No more points than this are drawn
uniform int marked = 0;        //! menu("nothing", "an edge", "a flip", "the last insertion") What is marked
uniform int number = 0;        //! slider(0, 60000) Which edge, three to each triangle, or which flip of the last insertion
uniform vec4 window = vec4(0.0, 0.0, 1.0, 1.0);  //! slider(0, 1) step(0.01) group("Picture") parts("left", "lower", "right", "upper") The part of the picture that it takes: its lower left, its upper right
uniform float margin = 0.1;    //! slider(0, 0.45) step(0.01) group("Picture") Room around the land, over the window
uniform vec4 face = vec4(0.95, 0.62, 0.28, 0.4);  //! colour group("Colours") Marked triangles

vec4 vertex(vec3 corner, out int element) {
    element = int(corner.x);
    ivec3 triangle = marked_triangle(triangles, neighbours, last, marked, number, element);
    if (triangle.x < 0) return vec4(0.0);
    int point = corner.y < 0.5 ? triangle.x : corner.y < 1.5 ? triangle.y : triangle.z;
    vec2 pixel = pixel_of_place(entry(places, point).xy, lattice_sides(places), size, window, margin);
    return clip_of_pixel(pixel, size);
}

vec4 fragment(int element) {
    return face;
}
