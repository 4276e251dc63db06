// The trees of a part, a texel a cell: foot and height, and what they are drawn by.
#include "terrain/heightfield.glsl"
#include "trees/place/cell.glsl"

uniform sampler2D heights;
uniform sampler2D woods;
uniform ivec2 first;      // the world's number of the part's first cell
uniform float side;       // of a cell [m]
uniform float width;      // of the part [m]
uniform float relief;
uniform float lowest;     // no tree stands lower: the sea, above height 0 [m]
uniform float tallest;
uniform float shortest;
uniform int seed;
// From the part's corner, above height 0, and how tall [m]; 0: none.
layout(location = 0) out vec4 tree;
// Its rank, the density around, what the terrain leaves of the sun.
layout(location = 1) out vec4 own;
void main() {
    ivec2 here = ivec2(gl_FragCoord.xy);
    Rooted found = tree_in(first + here, uint(seed));
    vec2 place = (vec2(here) + 0.5 + found.off) * side;
    vec2 share = place / width;
    vec2 on = share * vec2(textureSize(woods, 0) - 1);
    float wanted = height_at(woods, on);
    float up = height_at(heights, share * vec2(textureSize(heights, 0) - 1)) * relief;
    float lit = texelFetch(woods, ivec2(on + 0.5), 0).g;
    bool is_there = found.chance < wanted && up > lowest;
    tree = vec4(place, up, is_there ? tallest * mix(shortest, 1.0, found.size) : 0.0);
    own = vec4(found.rank, wanted, lit, 0.0);
}
