// trees/cover.glsl -- what trees make of a pixel's colour and light, single ones and whole woods.
//
//   gives    albedo; taken: of the sun what goes with the facing and what does not, and of the sky
//            (scene/shaded); shadow: what trees and another shadow leave of the sun
//   needs    colour/luminance.glsl, lighting/daylight_date.glsl, lighting/daylight_reading.glsl,
//            noise/gradient.glsl, scene/ground_reading.glsl, scene/surfaces.glsl,
//            terrain/heightfield.glsl, trees/light.glsl, trees/wood_reading.glsl; seen with
//            trees, scene/cover's albedo, a height, a density, the table of trees/wood and the
//            shadows of trees/shade; the sun's visible part with the woods on the terrain
//            (trees/canopy), if any; of trees/place the key, for the size of its table, and the
//            limit
//   units    metres; colours linear; shares 0..1
//   source   trees/stand.glsl
//   tested   tests/glsl/test_trees_light.py: a stand's mean colour is the same at any distance
//
// Farther away fewer trees are drawn, and what these hide less and less of is here, in the ground:
// so a wood goes on beyond its last tree in its own colour, with light and dark as of crowns.
// Ground between trees gets as much less light as they take.
#include "colour/luminance.glsl"
#include "lighting/daylight_reading.glsl"
#include "noise/gradient.glsl"
#include "scene/ground_reading.glsl"
#include "scene/surfaces.glsl"
#include "terrain/heightfield.glsl"
#include "trees/leaves_reading.glsl"
#include "trees/light.glsl"
#include "trees/species_reading.glsl"
#include "trees/wood_reading.glsl"
#pragma kernel(output = "albedo:rgba16f, taken:rgba16f, shadow:r16f")

uniform sampler2D seen;     //! input
uniform sampler2D cover;    //! input
uniform sampler2D height;   //! input
uniform sampler2D ground;   //! input("linear", "mipmap")
uniform sampler2D density;  //! input
uniform sampler2D table;    //! input
uniform sampler2D leaves;   //! input
uniform sampler2D species;  //! input("zero")
uniform sampler2D shade;    //! input("black")
uniform sampler2D other_shadow;  //! input("white")
uniform sampler2D canopy_visibility;  //! input("white")
uniform sampler2D key;      //! input("white")
uniform sampler2D limit;    //! input("white")
#include "lighting/parameters/sun.glsl"
#include "trees/parameters/reach.glsl"
#include "trees/parameters/stand.glsl"
#include "trees/parameters/shade.glsl"

// A texel of a map of the terrain, at a share of its sides.
float map_of(sampler2D map, vec2 share) {
    return height_at(map, clamp(share, 0.0, 1.0) * vec2(textureSize(map, 0) - 1));
}

const float LATER = 7.0;  // days that crowns in a lump are before others
const uint SALT = 0x396fa381u;  // CRC-32 of "trees/cover"

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

// How much of the sun is taken away here, and 1 in the square where that is known, else 0.
vec2 shade_at(vec2 place) {
    vec2 at = (place - eye.xy) / shade_wide;
    float aside = max(abs(at.x), abs(at.y));
    if (!wired_shade || aside >= 0.5) return vec2(0.0);
    vec2 on = (at + 0.5) * vec2(textureSize(shade, 0)) - 0.5;
    return vec2(height_at(shade, on), 1.0 - smoothstep(0.42, 0.49, aside));
}

// What woods leave of the sun that the bare terrain lets through here. They are opaque there, so
// where single trees throw their shadows these alone are taken.
float shadow_of_woods(vec2 share, float bare) {
    if (!wired_canopy_visibility || bare < 1e-3) return 1.0;
    return min(map_of(canopy_visibility, share) / bare, 1.0);
}

void kernel(ivec2 texel, out vec4 albedo, out vec4 taken, out float shadow) {
    vec4 at = texelFetch(seen, texel, 0);
    albedo = texelFetch(cover, texel, 0);
    taken = vec4(1.0, 0.0, 1.0, 1.0);
    float other = wired_other_shadow ? texelFetch(other_shadow, texel, 0).r : 1.0;
    shadow = other;
    bool tree = is_object(at.w) && is_tree(kind_of(at.w));
    if (!is_object(at.w) && !is_top(at.w)) return;
    if (skips_rest()) return;
    vec2 share = at.xy / extent;
    float stands = clamp(map_of(density, share), 0.0, 1.0);
    float eye_distance = distance(eye, at.xyz);
    vec3 to_eye = normalize(eye - at.xyz);
    Ground around = ground_at(ground, at.xy, extent, 2.0 * cell);
    vec3 to_sun = sun_direction(wired_daylight, daylight, towards_sun);
    // No lower than where the table of trees/wood ends; by night there is no sun.
    vec2 rises = max(vec2(rise_of(to_eye, around.slope), rise_of(to_sun, around.slope)), LOWEST);
    if (to_sun.z <= 0.0) rises.y = 0.0;
    vec4 others = species_at(species, share);
    Stand stand = stand_of(stands, cell, tallest, shortest, others);
    float end = wired_key ? end_of_table(reach, cell, textureSize(key, 0)) : reach;
    Stand drawn = thinned(stand, eye_distance, whole, end, texelFetch(limit, ivec2(0), 0).r);
    float phase = leaf_phase(to_eye, to_sun);
    if (tree) {
        float over = at.z - map_of(height, share) * relief;
        vec2 light = tree_light(stand, drawn, normal_of(at.w), over, to_eye, to_sun, rises);
        albedo.rgb = colour_of_tree(leaves, kind_of(at.w), late_at(at.xy));
        taken = vec4(0.0, phase * light.x, light.y, 1.0);
        return;
    }
    vec2 shaded = shade_at(at.xy);
    shadow = other * mix(shadow_of_woods(share, around.sun), 1.0 - shaded.x, shaded.y);
    if (stands <= 0.0) return;
    float sun_left = mix(reaches(stand, 1.0, to_sun, rises.y), 1.0, shaded.y);
    float sky_left = exp(-depth_of_sky(stand));
    taken = vec4(sun_left, 0.0, sky_left, 1.0);
    if (is_object(at.w)) return;
    // What of the ground all trees leave free, over what those leave free that are drawn.
    float free = reaches(stand, 1.0, to_eye, rises.x);
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
    Depths depths = Depths(depth_towards(stand, to_eye, rises.x),
                           depth_towards(stand, to_sun, max(rises.y, LOWEST)),
                           depth_of_sky(stand));
    vec2 lit = wood_at(table, to_eye, to_sun, depths, in_sight.z + in_sight.w);
    taken = mix(taken, vec4(0.0, phase * lit.x, lit.y, 1.0), part);
}
