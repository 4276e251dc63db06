// view/bloom/down.glsl -- a picture at half its size, no light lost.
//
//   gives    spread: linear light
//   needs    a picture in linear light
//   units    light without unit
//   source   the mean over each texel's own area: derived here
//   tested   tests/glsl/test_after.py: the mean of all pixels stays, at odd sizes too
#pragma kernel(output = "spread:rgba16f", repeat = "1 if bloom > 0 else 0")

uniform sampler2D picture;  //! input
#include "view/parameters/bloom.glsl"

vec4 kernel(ivec2 texel) {
    ivec2 pixels = textureSize(picture, 0);
    vec2 side = vec2(pixels) / vec2(size);
    vec2 first = vec2(texel) * side, last = first + side;
    ivec2 low = ivec2(first), high = min(ivec2(ceil(last)), pixels);
    vec4 total = vec4(0.0);
    float area = 0.0;
    for (int y = low.y; y < high.y; y++) {
        float tall = min(last.y, float(y + 1)) - max(first.y, float(y));
        for (int x = low.x; x < high.x; x++) {
            float part = tall * (min(last.x, float(x + 1)) - max(first.x, float(x)));
            total += part * texelFetch(picture, ivec2(x, y), 0);
            area += part;
        }
    }
    return total / area;
}
