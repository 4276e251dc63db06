// trees/species.glsl -- which species stand where: in patches, by height, slope, side and wetness.
//
//   gives    species: the shares of maples, birches, pines and spruces of the trees of a place;
//            the rest are oaks
//   needs    noise/gradient.glsl, terrain/heightfield.glsl, terrain/maps.glsl, trees/crown.glsl; a
//            height; wetness, if there is one
//   units    shares 0..1; metres above sea level; slopes in metres over metres
//   source   shares made here, by the rule of the Appalachians: maples and birches on moist ground
//            that faces away from the sun, oaks and pines on dry ground that faces it, spruces
//            high up (Whittaker 1956, "Vegetation of the Great Smoky Mountains", Ecological
//            Monographs 26(1))
//   tested   tests/glsl/test_trees_species.py
#include "noise/gradient.glsl"
#include "terrain/heightfield.glsl"
#include "terrain/maps.glsl"
#include "trees/crown.glsl"
#pragma kernel(output = "species:rgba8")

uniform sampler2D height;   //! input
uniform sampler2D wetness;  //! input("black")
#include "trees/parameters/species.glsl"
uniform float patch_wide = 420.0;  //! log_slider(10, 10000) unit("m") group("Species")
                                   //! How wide patches of one species are
uniform float patchy = 1.0;        //! slider(0, 1) step(0.01) group("Species")
                                   //! How much patches of one species differ
uniform uint seed = 5u;            //! slider(0, 9999) Which patches

const uint SALT = 0x7a1e1d33u;  // CRC-32 of "trees/species"

// Two octaves, from -1 to 1 nearly.
float patches(vec2 place, uint which) {
    vec2 at = place / patch_wide;
    uint key = seed + SALT + 2u * which;
    float noise = perlin(at, key).x + 0.55 * perlin(2.7 * at + 0.37, key + 1u).x;
    return clamp(1.3 * patchy * noise, -1.0, 1.0);
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 at = place_on(grid, texel, size);
    float metres = height_at(height, at) * relief + base_elevation;
    vec2 slope = relief * slope_at(height, at, spacing_of(grid, extent), CENTRAL_DIFFERENCES);
    vec2 place = share_of_texel(texel, size) * extent;
    // Ground that rises to the north faces the noon's sun.
    float moist = clamp(-1.5 * slope.y, -0.6, 0.6);
    if (wired_wetness) moist += 1.5 * clamp(map_at(wetness, texel, size).r, 0.0, 1.0) - 0.2;
    float needled = needle_share(needles, needles_from, metres);
    // Its mean stays, wherever it is.
    needled += needled * (1.0 - needled) * patches(place, 0u);
    // Spruces where needles have the hill to themselves.
    float spruce = clamp(0.3 + 0.5 * needled + 0.4 * patches(place, 1u), 0.0, 1.0);
    float maple = smoothstep(-0.85, 1.15, patches(place, 2u) + 0.6 * moist);
    float birch = smoothstep(-0.45, 1.35, patches(place, 3u) + 0.4 * moist);
    float broad = 1.0 - needled;
    birch *= broad * 0.7;
    maple *= (broad - birch) * 0.8;
    return vec4(maple, birch, needled * (1.0 - spruce), needled * spruce);
}
