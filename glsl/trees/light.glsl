// trees/light.glsl -- the light on a tree's crown, as far away as it is.
//
//   gives    tree_light
//   needs    trees/stand.glsl
//   units    shares of the light
//   source   trees/stand.glsl
//   tested   tests/glsl/test_trees_light.py: a stand's mean colour is the same at any distance,
//            and whatever there is room for
//
// A tree far away stands for several: it is larger than they are, and one sees deeper between it
// and the next. The light on it is that of what they would show there: as deep in the stand, and
// as much turned upwards. With the normals of its own lower half a stand of few trees is darker
// by a tenth.
#ifndef TREES_LIGHT
#define TREES_LIGHT
#include "trees/stand.glsl"

// Shares of the sun, as of what faces it, and of the sky. `stand`, `drawn`: the stand around, and
// what of it is drawn so far away (`thinned`); `height`: over the ground; `rises`: of the ways to
// the eye and to the sun (rise_of).
vec2 tree_light(Stand stand, Stand drawn, vec3 normal, float height, vec3 to_eye, vec3 to_sun,
                vec2 rises) {
    float above = share_above(drawn, height);
    float share = share_in(stand, drawn, above, to_eye, rises.x);
    return crown_light(stand, normal_in(normal, above, share), share, to_sun, rises.y);
}
#endif
