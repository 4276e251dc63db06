// scene/ground_reading.glsl -- the ground under a pixel, as scene/ground packs it.
//
//   gives    Ground, ground_at
//   needs    maths/drape.glsl; the texture, with levels of detail, comes as an argument
//   units    metres; slopes in metres over metres; shares 0..1
//   source   none: the order of channels in scene/ground
//   tested   tests/glsl/test_scene.py
#ifndef SCENE_GROUND_READING
#define SCENE_GROUND_READING
#include "maths/drape.glsl"

struct Ground {
    vec2 slope;  // east and north
    float sky;   // share of the sky above
    float sun;   // visible part of the sun
};

// At a place of a terrain so many metres wide, its mean over a square so many metres wide.
Ground ground_at(sampler2D ground, vec2 place, vec2 metres, float wide) {
    ivec2 texels = textureSize(ground, 0);
    // By the finer axis: the other would leave its texels between those that are read.
    vec2 texels_wide = wide * vec2(texels - 1) / metres;
    float level = log2(max(max(texels_wide.x, texels_wide.y), 1e-3));
    vec4 found = textureLod(ground, drape_uv(place / metres, texels), level);
    return Ground(found.rg, found.b, found.a);
}
#endif
