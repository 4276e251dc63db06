// trees/place/cells.glsl -- at most one tree in each cell of a square around the eye.
//
//   gives    tree: its foot east, north and up, and how tall it is, 0 for none; key: its rank over
//            the share of trees that is drawn so far away, below 1 for one that is drawn, else 2;
//            and how near to its end a tree of key 1 is (drawn_part)
//   needs    terrain/heightfield.glsl, trees/level.glsl, trees/place/cell.glsl,
//            water/sheet_reading.glsl; a height, a density, the camera; water, in which none
//            stands, if there is any
//   units    metres; density 0..1
//   source   trees/place/cell.glsl; by level: Cook and others 2007 (trees/level.glsl)
//   tested   tests/glsl/test_trees.py, by counts against the density's integral
#include "terrain/heightfield.glsl"
#include "trees/level.glsl"
#include "trees/place/cell.glsl"
#include "water/sheet_reading.glsl"
#pragma kernel(output = "tree:rgba32f, key:rg32f")

uniform sampler2D height;          //! input
uniform sampler2D density;         //! input("white")
uniform sampler2D water;           //! input("zero")
#include "trees/parameters/reach.glsl"
#include "trees/parameters/stand.glsl"
uniform bool all_round = false;    //! Those outside the picture as well
uniform float margin = 60.0;       //! slider(0, 500) unit("m")
                                   //! How far outside the picture trees are drawn: shadows come in
uniform uint seed = 5u;            //! slider(0, 9999) Which trees

// Whether a place, anywhere between two heights, may be in the picture, or so many metres beside
// it.
bool may_be_seen(vec2 place, float low, float high, float outside) {
    mat4 rows = transpose(clip_from_world);
    for (int k = 0; k < 4; k++) {
        vec4 plane = rows[3] + ((k & 1) == 0 ? rows[k >> 1] : -rows[k >> 1]);
        float level = dot(plane.xy, place) + plane.w;
        float inside = level + max(plane.z * low, plane.z * high);
        if (inside < -outside * length(plane.xyz)) return false;
    }
    return true;
}

void kernel(ivec2 texel, out vec4 tree, out vec2 key) {
    tree = vec4(0.0);
    key = vec2(2.0, 1.0);
    ivec2 here = ivec2(floor(eye.xy / cell)) + texel - size / 2;
    // Nearly all of the cells end here, and their neighbours with them: wherever in it the tree
    // stands, a cell beside the terrain or the picture has none.
    vec2 middle = (vec2(here) + 0.5) * cell;
    float top = max(relief + 2.0 * tallest, 0.0);
    if (any(lessThan(middle, vec2(-cell))) || any(greaterThan(middle, extent + cell))) return;
    if (!all_round && !may_be_seen(middle, min(relief, 0.0), top, margin + cell)) return;
    if (skips_rest()) return;
    Rooted own = tree_in(here, seed);
    vec2 place = (vec2(here) + 0.5 + own.off) * cell;
    vec2 share = place / extent;
    if (any(lessThan(share, vec2(0.0))) || any(greaterThan(share, vec2(1.0)))) return;
    float wanted = 1.0;
    if (wired_density) wanted = height_at(density, share * vec2(textureSize(density, 0) - 1));
    if (own.chance >= wanted) return;
    float up = height_at(height, share * vec2(textureSize(height, 0) - 1)) * relief;
    if (wired_water && up <= sheet_at(water, share).level) return;
    float eye_distance = distance(eye, vec3(place, up));
    float end = end_of_table(reach, cell, size);
    float kept = kept_share(eye_distance, whole, end);
    if (own.rank >= drawn_share(kept)) return;
    if (!all_round && !may_be_seen(place, up, up + 2.0 * tallest, margin)) return;
    float tall = tallest * mix(shortest, 1.0, own.size);
    tree = vec4(place, up, tall * growth_of_kept(eye_distance, whole, end));
    key = vec2(own.rank / drawn_share(kept), drawn_part(kept));
}
