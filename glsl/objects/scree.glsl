// objects/scree.glsl -- how densely loose rocks lie: on slopes, in heaps, on rock; not on paths.
//
//   gives    rocks, 0..1: the share of the cells of trees/place that hold a rock
//   needs    noise/gradient.glsl, terrain/heightfield.glsl, terrain/maps.glsl; a height; if wired,
//            weights of four layers (grass, rock, snow, path) and the cover of paths
//   units    slopes in metres over metres; shares 0..1
//   source   made here: loose rocks come to rest below the angle of repose, 35 degrees or 0.7
//   tested   tests/glsl/test_undergrowth.py
#include "noise/gradient.glsl"
#include "terrain/heightfield.glsl"
#include "terrain/maps.glsl"
#pragma kernel(output = "rocks:r16f")

uniform sampler2D height;   //! input
uniform sampler2D weights;  //! input("white")
uniform sampler2D paths;    //! input("black")
uniform float strewn = 0.02;  //! slider(0, 1) step(0.01) Density on level ground
uniform float piled = 0.5;    //! slider(0, 1) step(0.01) Density on steep ground
uniform vec2 lies = vec2(0.35, 0.6);   //! slider(0, 5) parts("from", "most")
                                       //! Slopes between which there are more and more
uniform vec2 slides = vec2(0.9, 1.3);  //! slider(0, 5) parts("from", "none")
                                       //! Slopes between which there are fewer again
uniform float heaps = 0.7;    //! slider(0, 1) step(0.01) How much rocks lie in heaps
uniform float heap_wide = 60.0;  //! log_slider(1, 1000) unit("m") How wide a heap is
uniform uint seed = 5u;       //! slider(0, 9999) Which heaps

const uint SALT = 0xe4639151u;  // CRC-32 of "objects/scree"

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 at = place_on(grid, texel, size);
    vec2 rise = slope_at(height, at, spacing_of(grid, extent), CENTRAL_DIFFERENCES);
    float slope = relief * length(rise);
    float density = mix(strewn, piled, smoothstep(lies.x, max(lies.y, lies.x + 1e-4), slope));
    density *= 1.0 - smoothstep(slides.x, max(slides.y, slides.x + 1e-4), slope);
    vec2 place = share_of_texel(texel, size) * extent / heap_wide;
    // Of mean 1, so that heaps take from what is between them.
    density *= 1.0 + heaps * 1.4 * clamp(perlin(place, seed + SALT).x, -0.7, 0.7);
    if (wired_weights) {
        vec4 layers = map_at(weights, texel, size);
        density = max(density * (1.0 - layers.z - layers.w), 0.5 * piled * layers.y);
    }
    if (wired_paths) density *= 1.0 - clamp(map_at(paths, texel, size).r, 0.0, 1.0);
    return clamp(density, 0.0, 1.0);
}
