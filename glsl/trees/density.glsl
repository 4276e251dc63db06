// trees/density.glsl -- how densely trees stand: by slope, height, wetness, layer; not on paths.
//
//   gives    density, 0..1: the share of the cells of trees/place that hold a tree
//   needs    noise/gradient.glsl, terrain/heightfield.glsl, terrain/maps.glsl; a height; if wired
//            wetness, weights of four layers, a painted density, and the cover of paths
//   units    slopes in metres over metres; heights in metres above sea level; all else 0..1
//   source   made here: each reason for fewer trees is a factor of its own
//   tested   tests/glsl/test_trees.py, on planes
#include "noise/gradient.glsl"
#include "terrain/heightfield.glsl"
#include "terrain/maps.glsl"
#pragma kernel(output = "density:r16f")

uniform sampler2D height;   //! input
uniform sampler2D wetness;  //! input("black")
uniform sampler2D weights;  //! input("white")
uniform sampler2D painted;  //! input("white")
uniform sampler2D paths;    //! input("black")
uniform float maximum = 1.0;       //! slider(0, 1) step(0.01) Density of the densest stand
uniform vec2 steep = vec2(0.75, 1.0);  //! slider(0, 5) parts("from", "none")
                                       //! Slopes between which trees grow fewer
uniform float lowest = -500.0;     //! slider(-500, 9000) unit("m")
                                   //! Above sea level: lower there are none
uniform float highest = 9000.0;    //! slider(-500, 9000) unit("m") The tree line
uniform float band = 60.0;         //! log_slider(1, 1000) unit("m")
                                   //! How gradually both ends come
uniform float wet = 0.0;           //! slider(-1, 1) step(0.01)
                                   //! 1: only on wet ground, -1: only on dry ground, 0: on either
uniform vec4 bears = vec4(1.0, 0.15, 0.0, 0.0);  //! slider(0, 1)
                                   //! parts("grass", "rock", "snow", "path")
                                   //! How well trees grow on each layer of the weights
uniform float clearings = 0.0;     //! slider(0, 1) step(0.01) Share of the ground that is meadow
uniform float clearing = 600.0;    //! log_slider(10, 10000) unit("m") How wide a clearing is
uniform uint seed = 5u;            //! slider(0, 9999) Which clearings

const uint SALT = 0x1fb980dbu;  // CRC-32 of "trees/density"

// Of two octaves of noise as they are summed here, half the values lie within this of 0.
const float HALF_OF_NOISE = 0.22;

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 at = place_on(grid, texel, size);
    float metres = height_at(height, at) * relief + base_elevation;
    vec2 rise = slope_at(height, at, spacing_of(grid, extent), CENTRAL_DIFFERENCES);
    float slope = relief * length(rise);
    // anchor: reasons
    float density = maximum * (1.0 - smoothstep(steep.x, max(steep.y, steep.x + 1e-4), slope));
    density *= smoothstep(lowest, lowest + band, metres);
    density *= 1.0 - smoothstep(highest - band, highest, metres);
    // end: reasons
    if (wired_wetness) {
        float soaked = clamp(map_at(wetness, texel, size).r, 0.0, 1.0);
        density *= 1.0 - abs(wet) * (wet > 0.0 ? 1.0 - soaked : soaked);
    }
    if (wired_weights) density *= clamp(dot(bears, map_at(weights, texel, size)), 0.0, 1.0);
    if (clearings > 0.0) {
        vec2 place = share_of_texel(texel, size) * extent / clearing;
        float noise = perlin(place, seed + SALT).x;
        noise += 0.5 * perlin(2.3 * place, seed + SALT + 1u).x;
        // As if the noise were even: near enough to its true distribution.
        float level = (1.0 - 2.0 * clearings) * 2.0 * HALF_OF_NOISE;
        density *= 1.0 - smoothstep(level - 0.06, level + 0.06, noise);
    }
    if (wired_painted) density *= clamp(map_at(painted, texel, size).r, 0.0, 1.0);
    if (wired_paths) density *= 1.0 - clamp(map_at(paths, texel, size).r, 0.0, 1.0);
    return density;
}
