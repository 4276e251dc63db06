// What a sketch says of its trees, and the sun and the sky over them.
#include "trees/light.glsl"
uniform float whole;
uniform float reach;
uniform float room;          // of a picture: trees/list/budget
uniform float cell;
uniform float tallest;
uniform float shortest;
uniform float needles;
uniform float needles_from;
uniform vec3 leaf_colours[2];  // of broad leaves on the mean, of needles
uniform float day;
uniform float base;          // of height 0 above the sea [m]
uniform vec3 sun_light;      // on what faces it, nothing in the way; none by night
uniform vec3 sky_light;      // on open level ground
uniform vec3 level_eye;      // the eye, from where distances say how many trees are drawn

vec4 species_at(float metres) { return shares_with(needle_share(needles, needles_from, metres)); }

Stand stand_at(float density, float metres) {
    return stand_of(density, cell, tallest, shortest, species_at(metres));
}

Stand drawn_of(Stand around, float away) { return thinned(around, drawn_of_stand(away, whole, reach, room)); }
