// generation/delaunay/picture/dots.glsl -- the points of a triangulation.
//
//   gives    frame, colours times their cover, over an earlier frame
//   needs    generation/delaunay/picture/{drawn,parameters/points}.glsl
//   units    pixels; colours linear
//   source   Belaiche 2010, section 1.3.8, figures 1.26 to 1.28
//   tested   tests/glsl/test_delaunay.py, by the picture's own pixels
#include "generation/delaunay/picture/drawn.glsl"
#pragma draw(mesh = "triangles", count = "points + 4", output = "frame:rgba16f", \
             depth = "none", blend = "alpha", samples = 1)

#include "generation/delaunay/picture/parameters/points.glsl"
uniform float dot_radius = 3.0; //! slider(0, 20) step(0.1) group("Picture") label("Points")
                                //! Radius of the points
uniform vec4 ink = vec4(0.05, 0.05, 0.06, 1.0);    //! colour group("Colours") Edges and points
uniform vec4 legal = vec4(0.02, 0.33, 0.10, 1.0);  //! colour group("Colours")
    //! A marked edge that is legal, and edges of the newest point

vec2 pixel_of(int point) {
    return pixel_of_place(entry(places, point).xy, lattice_sides(places), size, window, margin);
}

vec4 vertex(vec3 corner, out int point) {
    point = int(corner.x);
    // Each point adds two triangles to the two between the corners.
    if (dot_radius <= 0.0 || point >= triangles_of(last) / 2 + 3) return vec4(0.0);
    return clip_of_pixel(pixel_of(point) + covering(corner.y) * (dot_radius + 1.0), size);
}

vec4 fragment(int point) {
    bool is_newest = marked >= A_FLIP && point == int(entry(last, 0).x);
    vec4 colour = is_newest ? legal : ink;
    float cover = clamp(dot_radius + 0.5 - distance(gl_FragCoord.xy, pixel_of(point)), 0.0, 1.0);
    return vec4(colour.rgb, colour.a * cover);
}
