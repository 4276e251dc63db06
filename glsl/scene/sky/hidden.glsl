// scene/sky/hidden.glsl -- whether all of the picture that reads a texel shows something else.
//
//   gives    sky_hidden
//   needs    scene/surfaces.glsl; what each pixel shows, as by scene/where
//   units    texels of a picture that is stretched over all pixels, and read between its texels
//   source   none: what linear filtering reads
//   tested   tests/glsl/test_scene_sky.py: the same picture with it and without
#ifndef SCENE_SKY_HIDDEN
#define SCENE_SKY_HIDDEN
#include "scene/surfaces.glsl"

bool sky_hidden(sampler2D seen, ivec2 texel, ivec2 picture) {
    ivec2 pixels = textureSize(seen, 0);
    vec2 ratio = vec2(pixels) / vec2(picture);
    ivec2 low = max(ivec2(floor((vec2(texel) - 0.5) * ratio - 0.5)), 0);
    ivec2 high = min(ivec2(ceil((vec2(texel) + 1.5) * ratio - 0.5)), pixels - 1);
    for (int y = low.y; y <= high.y; y++) {
        for (int x = low.x; x <= high.x; x++) {
            if (is_sky(texelFetch(seen, ivec2(x, y), 0).a)) return false;
        }
    }
    return true;
}
#endif
