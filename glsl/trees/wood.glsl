// trees/wood.glsl -- the colour of ground with trees on it, that of the wood where none are drawn.
//
//   gives    colour
//   needs    lighting/daylight_reading.glsl, lighting/parameters/, terrain/heightfield.glsl,
//            terrain/maps.glsl, trees/stand.glsl; a colour, a height and a density
//   units    metres; colours linear
//   source   trees/stand.glsl
//   tested   tests/glsl/test_trees_light.py: a stand's mean colour is the same at any distance
//
// What single trees hide less and less of, the farther they are, is here; so a wood goes on
// beyond them in its own colour. The light is later multiplied by this colour as by any other, so
// what makes a wood darker than level ground, its crowns and the shade between them, is in it.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#include "terrain/maps.glsl"
#include "trees/stand.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D colour;   //! input("white")
uniform sampler2D height;   //! input
uniform sampler2D density;  //! input
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sunlight.glsl"
#include "lighting/parameters/skylight.glsl"
#include "trees/parameters/reach.glsl"
#include "trees/parameters/stand.glsl"
#include "trees/parameters/species.glsl"
#include "trees/parameters/season.glsl"

float brightness(vec3 light) { return dot(light, vec3(0.2126, 0.7152, 0.0722)); }

vec4 kernel(ivec2 texel) {
    vec3 ground = wired_colour ? map_at(colour, texel, size).rgb : vec3(1.0);
    float stands = clamp(map_at(density, texel, size).r, 0.0, 1.0);
    if (stands <= 0.0) return vec4(ground, 1.0);
    ivec2 grid = textureSize(height, 0);
    vec2 on = place_on(grid, texel, size);
    vec3 place = vec3(share_of_texel(texel, size) * extent, height_at(height, on) * relief);
    float needled = needle_share(needles, needles_from, place.z + base_elevation);
    Stand all = stand_of(stands, cell, tallest, shortest, needled);
    float away = distance(eye, place);
    vec3 to_eye = normalize(eye - place + vec3(0.0, 0.0, 1e-3));
    to_eye = normalize(vec3(to_eye.xy, max(to_eye.z, 0.02)));
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, sky_colour);
    vec3 to_sun = normalize(vec3(from.direction.xy, max(from.direction.z, 0.02)));
    WoodLight wood = wood_light(all, to_eye, to_sun);
    // What of the ground all trees leave free, over what those leave free that are drawn.
    float drawn = reaches(thinned(all, away, whole, reach), 0.0, to_eye);
    float hidden = 1.0 - clamp((1.0 - wood.cover) / max(drawn, 1e-6), 0.0, 1.0);
    // The light that falls on the ground without trees, which this colour is multiplied by.
    vec3 normal = normal_of_slope(relief * slope_at(height, on, spacing_of(grid, extent), 0));
    float sun_light = brightness(from.sun) * gain;
    float sky_light = brightness(from.sky) * ambient;
    float open = sun_light * max(dot(normal, from.direction), 0.0) + sky_light;
    float crowns = dot(wood.light, vec2(sun_light, sky_light)) / max(open, 1e-6);
    vec3 leaves = mean_leaf_colour(needled, day) * min(crowns, 2.0);
    return vec4(mix(ground, leaves, hidden), 1.0);
}
