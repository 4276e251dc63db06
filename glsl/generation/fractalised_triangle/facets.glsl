// generation/fractalised_triangle/facets.glsl -- a divided triangle drawn flat, with its edges.
//
//   gives    colour
//   needs    maths/whole.glsl, noise/hash.glsl
//   units    colours linear
//   source   Belaiche 2010, section 1.2.1, figure 1.4
//   tested   tests/glsl/test_deterministic_fractal.py, against facets and edges in NumPy
//
// Each pixel looks at every facet: a drawing for a lesson, not for a terrain. Of facets that
// overlap, the last is seen.
#include "maths/whole.glsl"
#include "noise/hash.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D point;     //! input
uniform int depth = 5;       //! slider(0, 6) How many times each edge is halved
uniform bool panels = true;  //! Show the first six states side by side, as far as the depth goes
uniform vec3 ink = vec3(0.012, 0.03, 0.07);   //! colour Colour of the edges
uniform vec3 paper = vec3(0.86, 0.84, 0.78);  //! colour Colour of the ground

const uint SALT = 0xd5257541u;  // CRC-32 of "generation/fractalised_triangle/facets"
const vec3 DARK = vec3(0.16, 0.24, 0.10);
const vec3 BRIGHT = vec3(0.50, 0.44, 0.24);

// Twice the area of a triangle, above 0 where its corners go round to the left.
float turned(vec2 a, vec2 b, vec2 c) {
    vec2 u = b - a;
    vec2 v = c - a;
    return u.x * v.y - u.y * v.x;
}

float far_from_edge(vec2 place, vec2 a, vec2 b) {
    vec2 u = b - a;
    vec2 v = place - a;
    return length(v - u * clamp(dot(u, v) / max(dot(u, u), 1e-20), 0.0, 1.0));
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = panels ? ivec2(3, 2) : ivec2(1);
    ivec2 panel = ivec2(quotient(texel.x * grid.x, size.x), quotient(texel.y * grid.y, size.y));
    int maximum = textureSize(point, 0).x - 1;
    int halvings = panels ? min(panel.x + 3 * (1 - panel.y), depth) : depth;
    int edges = min(1 << halvings, maximum);
    int stride = quotient(maximum, max(edges, 1));
    vec2 room = vec2(size) / vec2(grid);
    float side = max(0.8 * min(room.x, room.y), 1.0);
    vec2 place = (vec2(texel) + 0.5 - (vec2(panel) + 0.5) * room) / side;

    vec3 shown = paper;
    float nearest = 1e9;
    for (int j = 0; j < edges; j++) {
        // A row has a facet upright at each place, and one upside down between each two.
        for (int n = 0; n < 2 * (edges - j) - 1; n++) {
            ivec2 low = ivec2(n >> 1, j);
            bool upright = (n & 1) == 0;
            vec2 a = texelFetch(point, (upright ? low : low + ivec2(1, 1)) * stride, 0).rg;
            vec2 b = texelFetch(point, (low + ivec2(1, 0)) * stride, 0).rg;
            vec2 c = texelFetch(point, (low + ivec2(0, 1)) * stride, 0).rg;
            vec3 sides = vec3(turned(a, b, place), turned(b, c, place), turned(c, a, place));
            if (all(greaterThanEqual(sides, vec3(0.0))) || all(lessThanEqual(sides, vec3(0.0)))) {
                shown = mix(DARK, BRIGHT, random(ivec2(n, j), uint(halvings) + SALT));
            }
            nearest = min(nearest, far_from_edge(place, b, c));
            nearest = min(nearest, min(far_from_edge(place, a, b), far_from_edge(place, c, a)));
        }
    }
    // Fainter where edges are many, or they would hide the facets.
    float line = clamp(1.1 - nearest * side, 0.0, 1.0) * (1.0 - 0.1 * float(halvings));
    return vec4(mix(shown, ink, line), 1.0);
}
