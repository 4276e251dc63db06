// generation/delaunay/tin.glsl -- a triangulation as terrain: each triangle is drawn as a plane.
//
//   gives    height at every texel, not normalised
//   needs    generation/delaunay/tables.glsl
//   units    heights without unit, in the range of the points' own
//   source   Belaiche 2010, section 1.3.8; the walk after Green and Sibson 1978,
//            "Computing Dirichlet Tessellations in the Plane" (The Computer Journal 21)
//   tested   tests/glsl/test_delaunay.py, against scipy.interpolate.LinearNDInterpolator
//
// In a triangle with the corners a, b, c the height at p is that of the plane through them:
//
//     h(p) = a.z + ((b.z - a.z) area(c, a, p) + (c.z - a.z) area(a, b, p)) / area(a, b, c)
//
// Corners of triangles are rounded to parts of a texel before they are drawn, and the terrain's
// border runs through the middles of texels: what is drawn is a triangle near the texel. From
// there each texel walks to the triangle that truly holds it, seldom more than one step, and
// takes the height of its plane at its own place. The terrain's four corners are drawn half a
// texel further out, so that no texel is missed.
#include "generation/delaunay/tables.glsl"
#pragma draw(mesh = "triangles", count = "2 * points + 2", output = "height:r32f", \
             depth = "none", samples = 1)

uniform sampler2D places;      //! input
uniform sampler2D triangles;   //! input
uniform sampler2D neighbours;  //! input
uniform int points = 60;       //! slider(0, 10000) Points inserted after the four corners

// In squares of the lattice: above the rounding of areas, and far below any texel's.
const float ON_THE_EDGE = 16.0;
const int LONGEST_WALK = 1000;

// corner: which triangle, and which of its vertices.
vec4 vertex(vec3 corner, out int drawn) {
    drawn = int(corner.x);
    ivec3 points_of = ivec3(entry(triangles, drawn).xyz);
    int point = corner.y < 0.5 ? points_of.x : corner.y < 1.5 ? points_of.y : points_of.z;
    vec2 place = entry(places, point).xy;
    vec2 sides = vec2(lattice_sides(places));
    vec2 texel = place / sides * vec2(size - 1) + 0.5;
    texel += 0.5 * (vec2(equal(place, sides)) - vec2(equal(place, vec2(0.0))));
    return vec4(texel / vec2(size) * 2.0 - 1.0, 0.0, 1.0);
}

// Twice the area between an edge and a place: positive on its left, where its triangle lies.
float left_of(ivec2 from, ivec2 to, ivec2 whole, vec2 rest) {
    ivec2 edge = to - from;
    return exact_cross(edge, whole - from) + (float(edge.x) * rest.y - float(edge.y) * rest.x);
}

vec4 fragment(int drawn) {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    ivec2 sides = lattice_sides(places);
    vec2 east = exact_place(texel.x, size.x, sides.x);
    vec2 north = exact_place(texel.y, size.y, sides.y);
    ivec2 whole = ivec2(east.x, north.x);
    vec2 rest = vec2(east.y, north.y);
    int triangle = drawn;
    vec3 a, b, c, areas;
    for (int i = 0; i < LONGEST_WALK; i++) {
        vec4 corners = entry(triangles, triangle);
        a = entry(places, int(corners.x)).xyz;
        b = entry(places, int(corners.y)).xyz;
        c = entry(places, int(corners.z)).xyz;
        areas.x = left_of(ivec2(b.xy), ivec2(c.xy), whole, rest);
        areas.y = left_of(ivec2(c.xy), ivec2(a.xy), whole, rest);
        areas.z = left_of(ivec2(a.xy), ivec2(b.xy), whole, rest);
        float least = min(areas.x, min(areas.y, areas.z));
        if (least >= -ON_THE_EDGE) break;
        vec4 across = entry(neighbours, triangle);
        float next = least == areas.x ? across.x : least == areas.y ? across.y : across.z;
        if (next < 0.0) break;
        triangle = int(next);
    }
    float doubled = exact_cross(ivec2(b.xy - a.xy), ivec2(c.xy - a.xy));
    // From one corner on, not a sum of three: between equal heights it is exactly that height.
    return vec4(a.z + ((b.z - a.z) * areas.z + (c.z - a.z) * areas.y) / doubled, 0.0, 0.0, 1.0);
}
