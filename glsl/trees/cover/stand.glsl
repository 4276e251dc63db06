// trees/cover/stand.glsl -- the stand of trees at each pixel, and what of it is drawn one by one.
//
//   gives    stand: the share of cells that hold a tree; of these, the share that is drawn as
//            single trees, and their growth; the height of what is seen over the ground
//   needs    scene/surfaces.glsl, terrain/heightfield.glsl, trees/stand.glsl; seen with trees, a
//            height, a density; of trees/place the key, for the size of its table, and the limit
//   units    metres; shares 0..1; growth as a factor of a tree's height
//   source   trees/level.glsl
//   tested   tests/glsl/test_trees_light.py: a stand's mean colour is the same at any distance
#include "scene/surfaces.glsl"
#include "terrain/heightfield.glsl"
#include "trees/stand.glsl"
#pragma kernel(output = "stand:rgba32f")

uniform sampler2D seen;     //! input
uniform sampler2D height;   //! input
uniform sampler2D density;  //! input
uniform sampler2D key;      //! input("white")
uniform sampler2D limit;    //! input("white")
#include "trees/parameters/cell.glsl"
#include "trees/parameters/reach.glsl"

float map_of(sampler2D map, vec2 share);

vec4 kernel(ivec2 texel) {
    vec4 at = texelFetch(seen, texel, 0);
    if (!is_object(at.w) && !is_top(at.w)) return vec4(0.0);
    vec2 share = at.xy / extent;
    float end = wired_key ? end_of_table(reach, cell, textureSize(key, 0)) : reach;
    vec2 drawn = drawn_of_stand(distance(eye, at.xyz), whole, end,
                                texelFetch(limit, ivec2(0), 0).r);
    return vec4(clamp(map_of(density, share), 0.0, 1.0), drawn,
                at.z - map_of(height, share) * relief);
}

// A map of the terrain, at a share of its sides.
float map_of(sampler2D map, vec2 share) {
    return height_at(map, clamp(share, 0.0, 1.0) * vec2(textureSize(map, 0) - 1));
}
