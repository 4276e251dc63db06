// trees/from_above.glsl -- trees on a map, at most one in each cell.
//
//   gives    picture: crowns on the ground, with their shadows; crown: 1 where there is one
//   needs    noise/hash.glsl, terrain/heightfield.glsl; a height; a density
//   units    metres; light without unit, 1 for white
//   source   a jittered lattice: Cook 1986, "Stochastic Sampling in Computer Graphics", ACM
//            Transactions on Graphics 5(1); thinning: Cook, Halstead, Planck and Ryu 2007,
//            "Stochastic Simplification of Aggregate Detail" (SIGGRAPH)
//   tested   tests/glsl/test_lesson_outdoors.py: how many there are, and what they cover
//
// Each pixel looks for the crowns over it. trees/place lists the same kind of trees for a draw,
// and thins them by their distance from the eye (trees/level.glsl), not evenly.
#include "noise/hash.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "picture:rgba16f, crown:r32f", relief = "shown")

uniform sampler2D height;    //! input
uniform sampler2D density;   //! input("white")
uniform float cell = 9.0;    //! log_slider(4, 40) unit("m") Side of a cell of the lattice
uniform float jitter = 0.8;  //! slider(0, 1) step(0.01)
                             //! In how much of its cell a tree may stand; 0: in the middle
uniform float radius = 3.0;  //! slider(0.5, 6) step(0.1) unit("m") Of a crown
uniform float kept = 1.0;    //! log_slider(0.02, 1) The share of the trees that is drawn
uniform float growth = 0.5;  //! slider(0, 1) step(0.01)
                             //! As fewer are drawn, trees grow: by kept to the power of minus it
uniform uint seed = 1u;      //! slider(0, 9999) Which trees

const uint SALT = 0x92c0a2a6u;  // CRC-32 of "lessons/trees_from_above"

struct Tree {
    vec2 foot;
    float half_wide;  // of its crown; 0 for none
    float tint;
};

float density_at(vec2 place) {
    vec2 last = vec2(textureSize(density, 0) - 1);
    return wired_density ? height_at(density, clamp(place / extent, 0.0, 1.0) * last) : 1.0;
}

// anchor: tree
Tree tree_in(ivec2 here) {
    vec2 off = jitter * (random_pair(here, seed + SALT) - 0.5);
    vec2 foot = (vec2(here) + 0.5 + off) * cell;
    float chance = random(here, seed + SALT + 1u);
    float rank = random(here, seed + SALT + 2u);
    bool stands = chance < density_at(foot) && rank < kept;
    return Tree(foot, stands ? radius * pow(kept, -growth) : 0.0, rank / kept);
}
// end: tree

void kernel(ivec2 texel, out vec4 picture, out float crown) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size) * extent;
    vec2 rise = slope_at(height, place / extent * vec2(textureSize(height, 0) - 1),
                         extent / vec2(textureSize(height, 0) - 1), CENTRAL_DIFFERENCES);
    vec3 normal = normalize(vec3(-relief * rise, 1.0));
    vec3 sun = normalize(vec3(-0.7, 0.45, 0.8));
    picture = vec4(vec3(0.24, 0.23, 0.10) * max(dot(normal, sun), 0.0) * 1.6, 1.0);
    crown = 0.0;
    // A crown may reach into a cell from as many cells around.
    int around = int(ceil(radius * pow(kept, -growth) / cell + 0.5)) + 1;
    ivec2 middle = ivec2(floor(place / cell));
    float shade = 1.0;
    for (int j = -around; j <= around; j++) {
        for (int i = -around; i <= around; i++) {
            Tree tree = tree_in(middle + ivec2(i, j));
            vec2 off = (place - tree.foot) / max(tree.half_wide, 1e-3);
            if (length(off) < 1.0 && tree.half_wide > 0.0) {
                float facing = dot(vec3(off, sqrt(1.0 - dot(off, off))), sun);
                vec3 leaves = mix(vec3(0.05, 0.10, 0.025), vec3(0.12, 0.12, 0.03), tree.tint);
                picture.rgb = leaves * (0.35 + 1.3 * max(facing, 0.0));
                crown = 1.0;
            }
            vec2 behind = off - vec2(0.9, -0.6);
            if (length(behind) < 1.0 && tree.half_wide > 0.0) shade = 0.45;
        }
    }
    if (crown == 0.0) picture.rgb *= shade;
}
