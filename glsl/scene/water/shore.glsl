// scene/water/shore.glsl -- where waves reach a shore: wet ground, and foam.
//
//   gives    run_up, band_share, wet_share, foam_at_shore
//   needs    noise/gradient.glsl, scene/footprint.glsl, water/foam.glsl, water/waves.glsl: pure
//            functions, no uniforms, no textures
//   units    metres; slopes in metres over metres; shares 0..1
//   source   wet ground is darker: Lekner and Dorf 1988, "Why some things are darker when wet",
//            Applied Optics 27; foam as in water/foam.glsl
//   tested   tests/glsl/test_scene_water.py
#ifndef SCENE_WATER_SHORE
#define SCENE_WATER_SHORE
#include "noise/gradient.glsl"
#include "scene/footprint.glsl"
#include "water/foam.glsl"
#include "water/waves.glsl"

const float WET_DARKENING = 0.4;
const float WASH = 0.25;  // longest waves that foam is wide at a wall

// How high waves reach over the water.
float run_up(Sea sea) { return 0.15 + 0.5 * sea.high; }

// A band along the shore, so high, that is narrower than a pixel has no more of it than its share.
float band_share(float high, float slope, float pixel) {
    return clamp(0.5 * high / (max(slope, 0.02) * pixel), 0.0, 1.0);
}

// How much darker ground is, so far above the water, that waves have reached.
float wet_share(Sea sea, float above, float slope, float pixel) {
    float reach = run_up(sea);
    return WET_DARKENING * band_share(reach, slope, pixel) * (1.0 - smoothstep(0.0, reach, above));
}

// Where waves run up a shore, and where they wash against a wall, in pieces along it; in water so
// deep over ground of a slope.
float foam_at_shore(vec2 place, float depth, vec2 slope, Footprint foot, float pixel, Sea sea,
                    float gust, float seconds, uint seed) {
    float steep = length(slope);
    float shore = shore_cover(depth, sea.high, seconds, gust)
            * band_share(BREAKER * sea.high, steep, pixel);
    vec2 uphill = slope / max(steep, 1e-6);
    float across = abs(dot(uphill, foot.right)) + abs(dot(uphill, foot.up));
    float wash = wash_cover(depth / max(steep, 0.05), WASH * sea.longest, across);
    float lump = perlin(place / (3.0 * sea.longest), seed).x;
    float broken = clamp(0.6 + 1.6 * lump, 0.0, 1.0);
    return max(shore, wash * broken * min(sea.high / 0.4, 1.0));
}
#endif
