// generation/delaunay/picture/faces.glsl -- marked triangles, filled.
//
//   gives    frame, colours times their cover, over an earlier frame
//   needs    generation/delaunay/picture/{drawn,parameters/points,parameters/triangles}.glsl
//   units    pixels; colours linear
//   source   Belaiche 2010, section 1.3.8, figures 1.27 and 1.28
//   tested   tests/glsl/test_delaunay.py, by the picture's own pixels
#include "generation/delaunay/picture/drawn.glsl"
#pragma draw(mesh = "triangles", count = "2 * points + 2", output = "frame:rgba16f", \
             depth = "none", blend = "alpha", samples = 1)

#include "generation/delaunay/picture/parameters/points.glsl"
#include "generation/delaunay/picture/parameters/triangles.glsl"
uniform vec4 face = vec4(0.95, 0.62, 0.28, 0.4);  //! colour group("Colours") Marked triangles

vec4 vertex(vec3 corner, out int element) {
    element = int(corner.x);
    ivec3 triangle = marked_triangle(triangles, neighbours, last, marked, number, element);
    if (triangle.x < 0) return vec4(0.0);
    int point = corner.y < 0.5 ? triangle.x : corner.y < 1.5 ? triangle.y : triangle.z;
    vec2 place = entry(places, point).xy;
    vec2 pixel = pixel_of_place(place, lattice_sides(places), size, window, margin);
    return clip_of_pixel(pixel, size);
}

vec4 fragment(int element) {
    return face;
}
