// scene/ground_pixel.glsl -- the ground that a pixel covers, and textures there.
//
//   gives    GroundPixel, ground_pixel, draped, tiled, mean_of
//   needs    maths/drape.glsl, scene/footprint.glsl, scene/ground_reading.glsl, view/surface.glsl;
//            textures with levels of detail come as arguments
//   units    metres; slopes in metres over metres
//   source   none: made here
//   tested   tests/glsl/test_scene.py, against view/terrain and view/splat
#ifndef SCENE_GROUND_PIXEL
#define SCENE_GROUND_PIXEL
#include "maths/drape.glsl"
#include "scene/footprint.glsl"
#include "scene/ground_reading.glsl"
#include "view/surface.glsl"

struct GroundPixel {
    vec2 slope;  // of the ground, the mean over the pixel
    Footprint foot;
};

// At a point that a pixel of the picture shows, which a ray from the eye meets.
GroundPixel ground_pixel(sampler2D ground, vec3 point, PixelRay ray, vec3 eye, vec2 extent) {
    float wide = distance(eye, point) * length(ray.up) / length(ray.ahead);
    vec2 slope = ground_at(ground, point.xy, extent, wide).slope;
    return GroundPixel(slope, footprint_of(ray, point - eye, normalize(vec3(-slope, 1.0))));
}

// A texture that lies over the whole terrain, at a place in metres.
vec4 draped(sampler2D image, vec2 place, Footprint foot, vec2 extent) {
    ivec2 texels = textureSize(image, 0);
    float level = level_of(foot, vec2(texels - 1) / extent) + SHARPER;
    return textureLod(image, drape_uv(place / extent, texels), level);
}

// A square tile that repeats so often from west to east.
vec3 tiled(sampler2D image, vec2 place, Footprint foot, float repeats, vec2 extent) {
    float density = repeats / extent.x;
    float level = level_of(foot, vec2(textureSize(image, 0)) * density) + SHARPER;
    return textureLod(image, place * density, level).rgb;
}

// The level after the last is the last: the image's mean.
vec3 mean_of(sampler2D image) {
    return textureLod(image, vec2(0.5), 99.0).rgb;
}
#endif
