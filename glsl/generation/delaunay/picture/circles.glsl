// generation/delaunay/picture/circles.glsl -- the circles through the corners of triangles.
//
//   gives    frame, colours times their cover, over an earlier frame
//   needs    generation/delaunay/picture/{drawn,parameters/points,parameters/triangles}.glsl
//   units    pixels; colours linear
//   source   Belaiche 2010, section 1.3.8, figures 1.26 to 1.28
//   tested   tests/glsl/test_delaunay.py, by the picture's own pixels
#include "generation/delaunay/picture/drawn.glsl"
#pragma draw(mesh = "triangles", count = "2 * points + 2", output = "frame:rgba16f", \
             depth = "none", blend = "alpha", samples = 1)

#include "generation/delaunay/picture/parameters/points.glsl"
#include "generation/delaunay/picture/parameters/triangles.glsl"
uniform int circles = 1;       //! menu("none", "all", "marked") Which triangles show their circle
uniform float line = 1.5;      //! slider(0, 8) step(0.1) group("Picture") Width of edges and
                               //! circles; 0: none
uniform vec4 circle = vec4(0.08, 0.28, 0.62, 0.7);  //! colour group("Colours") Circles

// Middle and radius in pixels; a radius below 0 where there is no such circle.
vec3 circle_of(int element) {
    ivec3 triangle = ivec3(-1);
    if (circles == 1 && element < triangles_of(last)) {
        triangle = ivec3(entry(triangles, element).xyz);
    } else if (circles == 2) {
        triangle = marked_triangle(triangles, neighbours, last, marked, number, element);
    }
    if (triangle.x < 0) return vec3(-1.0);
    // anchor: middle
    vec2 a = entry(places, triangle.x).xy;
    vec2 b = entry(places, triangle.y).xy - a;
    vec2 c = entry(places, triangle.z).xy - a;
    vec2 middle = dot(b, b) * vec2(c.y, -c.x) - dot(c, c) * vec2(b.y, -b.x);
    middle /= 2.0 * exact_cross(ivec2(b), ivec2(c));
    // end: middle
    ivec2 sides = lattice_sides(places);
    vec2 pixel = pixel_of_place(a + middle, sides, size, window, margin);
    return vec3(pixel, distance(pixel, pixel_of_place(a, sides, size, window, margin)));
}

vec4 vertex(vec3 corner, out int element) {
    element = int(corner.x);
    vec3 found = circle_of(element);
    if (found.z < 0.0 || line <= 0.0) return vec4(0.0);
    return clip_of_pixel(found.xy + covering(corner.y) * (found.z + line + 1.0), size);
}

vec4 fragment(int element) {
    vec3 found = circle_of(element);
    float off = abs(distance(gl_FragCoord.xy, found.xy) - found.z);
    // Pictures beside each other do not reach into each other.
    vec2 share = gl_FragCoord.xy / vec2(size);
    bool inside = all(greaterThan(share, window.xy)) && all(lessThan(share, window.zw));
    return vec4(circle.rgb, inside ? circle.a * clamp(0.5 * line + 0.5 - off, 0.0, 1.0) : 0.0);
}
