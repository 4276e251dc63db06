// trees/cover/lit.glsl -- the colour of trees and woods, and the light that they get and leave.
//
//   gives    albedo; taken: of the sun what goes with the facing and what does not, and of the sky
//            (scene/shaded)
//   needs    colour/luminance.glsl, lighting/daylight_reading.glsl, noise/gradient.glsl,
//            scene/ground_reading.glsl, scene/surfaces.glsl, trees/leaves_reading.glsl,
//            trees/light.glsl, trees/species_reading.glsl, trees/wood_reading.glsl; seen with
//            trees, scene/cover's albedo, the ground, trees/cover/stand, trees/cover/shadow, the
//            tables of trees/wood and trees/leaves; a daylight and the species, if there are
//   units    metres; colours linear; shares 0..1
//   source   trees/stand.glsl
//   tested   tests/glsl/test_trees_light.py: a stand's mean colour is the same at any distance
#include "colour/luminance.glsl"
#include "lighting/daylight_reading.glsl"
#include "noise/gradient.glsl"
#include "scene/ground_reading.glsl"
#include "scene/surfaces.glsl"
#include "trees/leaves_reading.glsl"
#include "trees/light.glsl"
#include "trees/species_reading.glsl"
#include "trees/wood_reading.glsl"
#pragma kernel(output = "albedo:rgba16f, taken:rgba16f")

uniform sampler2D seen;     //! input
uniform sampler2D cover;    //! input
uniform sampler2D ground;   //! input("linear", "mipmap")
uniform sampler2D stand;    //! input
uniform sampler2D single;   //! input
uniform sampler2D species;  //! input("zero")
uniform sampler2D table;    //! input
uniform sampler2D leaves;   //! input
#include "lighting/parameters/sun.glsl"
#include "trees/parameters/stand.glsl"

const float LATER = 7.0;  // days that crowns in a lump are before others
const uint SALT = 0x396fa381u;  // CRC-32 of "trees/cover"

vec2 lumps(vec2 place, float pixel);

void kernel(ivec2 texel, out vec4 albedo, out vec4 taken) {
    vec4 at = texelFetch(seen, texel, 0);
    albedo = texelFetch(cover, texel, 0);
    taken = vec4(1.0, 0.0, 1.0, 1.0);
    if (!is_object(at.w) && !is_top(at.w)) return;
    if (skips_rest()) return;
    vec4 here = texelFetch(stand, texel, 0);
    vec4 others = species_at(species, at.xy / extent);
    Stand all = stand_of(here.x, cell, tallest, shortest, others);
    Stand drawn = thinned(all, here.yz);
    float eye_distance = distance(eye, at.xyz);
    vec3 to_eye = normalize(eye - at.xyz);
    vec2 slope = ground_at(ground, at.xy, extent, 2.0 * cell).slope;
    vec3 to_sun = sun_direction(wired_daylight, daylight, towards_sun);
    // No lower than where the table of trees/wood ends; by night there is no sun.
    vec2 rises = max(vec2(rise_of(to_eye, slope), rise_of(to_sun, slope)), LOWEST);
    if (to_sun.z <= 0.0) rises.y = 0.0;
    float phase = leaf_phase(to_eye, to_sun);
    if (is_object(at.w) && is_tree(kind_of(at.w))) {
        vec2 light = tree_light(all, drawn, normal_of(at.w), here.w, to_eye, to_sun, rises);
        albedo.rgb = colour_of_tree(leaves, kind_of(at.w), late_at(at.xy));
        taken = vec4(0.0, phase * light.x, light.y, 1.0);
        return;
    }
    if (here.x <= 0.0) return;
    float sun_left = mix(reaches(all, 1.0, to_sun, rises.y), 1.0, texelFetch(single, texel, 0).r);
    float sky_left = exp(-depth_of_sky(all));
    taken = vec4(sun_left, 0.0, sky_left, 1.0);
    if (is_object(at.w)) return;
    // What of the ground all trees leave free, over what those leave free that are drawn.
    float free = reaches(all, 1.0, to_eye, rises.x);
    float hidden = 1.0 - clamp(free / max(reaches(drawn, 1.0, to_eye, rises.x), 1e-6), 0.0, 1.0);
    if (hidden < 0.002) return;
    // Half the angle of a pixel is one over the lens's scale, times one over the picture's half.
    float lens = length(transpose(clip_from_world)[1].xyz);
    float pixel = 2.0 * eye_distance / (lens * float(size.y)) / sqrt(max(rises.x, 0.05));
    vec4 in_sight = others_in_sight(others);
    vec2 dapples = lumps(at.xy, pixel);
    float late = late_at(at.xy) + LATER * dapples.y;
    vec3 crowns = colour_of_wood(leaves, in_sight, late) * dapples.x;
    albedo.rgb = mix(albedo.rgb, crowns, hidden);
    // By brightness, what comes from the leaves of the colour that both have together.
    float part = hidden * luminance(crowns) / max(luminance(albedo.rgb), 1e-6);
    Depths depths = Depths(depth_towards(all, to_eye, rises.x),
                           depth_towards(all, to_sun, max(rises.y, LOWEST)), depth_of_sky(all));
    vec2 lit = wood_at(table, to_eye, to_sun, depths, in_sight.z + in_sight.w);
    taken = mix(taken, vec4(0.0, phase * lit.x, lit.y, 1.0), part);
}

// Light and dark of the crowns of a wood, of mean 1; and by how much they have turned more or less
// than their neighbours, of mean 0: octaves of noise from a pixel's width up, each as much weaker
// as its waves are wider. One octave alone looks like camouflage. A slope of noise knows nothing
// of its height, so that the lighter ones have not turned more, which would change the mean.
vec2 lumps(vec2 place, float pixel) {
    vec2 total = vec2(1.0, 0.0);
    float wave = 1.3 * cell;
    float strength = 1.0;
    for (int k = 0; k < 5; k++) {
        float shown = clamp(wave / pixel - 1.0, 0.0, 1.0);
        vec3 noise = perlin(place / wave + 0.37 * float(k), SALT + uint(k));
        total += shown * strength * noise.xy;
        wave *= 2.3;
        strength *= 0.69;  // 2.3^-0.45
    }
    return vec2(max(total.x, 0.1), total.y);
}
