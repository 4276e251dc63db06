// view/exposure/blocks.glsl -- the mean logarithm of the light of each block of a picture.
//
//   gives    blocks: the sum of the logarithms to base 2 of luminance, and the number of pixels
//   needs    colour/luminance.glsl; a picture in linear light
//   units    logarithms of light without unit
//   source   Reinhard, Stark, Shirley and Ferwerda 2002, "Photographic Tone Reproduction for
//            Digital Images" (SIGGRAPH), eq. 1
//   tested   tests/glsl/test_after.py, against NumPy in float64
//
// Each pixel is in one block. What is darker than a moonless night counts as that, and what is
// brighter than half floats hold, infinity in a picture of such, as the brightest of them: or one
// pixel would make the mean infinite.
#include "colour/luminance.glsl"
#pragma kernel(output = "blocks:rg32f", repeat = "1 if adapts else 0")

uniform sampler2D picture;  //! input
#include "view/parameters/adapts.glsl"

const float DARKEST = 1e-7;
const float BRIGHTEST = 65504.0;

vec2 kernel(ivec2 texel) {
    ivec2 pixels = textureSize(picture, 0);
    ivec2 first = texel * pixels / size, last = (texel + 1) * pixels / size;
    float total = 0.0;
    for (int y = first.y; y < last.y; y++) {
        for (int x = first.x; x < last.x; x++) {
            vec3 light = texelFetch(picture, ivec2(x, y), 0).rgb;
            total += log2(clamp(luminance(light), DARKEST, BRIGHTEST));
        }
    }
    return vec2(total, float((last.x - first.x) * (last.y - first.y)));
}
