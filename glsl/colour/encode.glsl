// colour/encode.glsl -- sRGB's encoding of linear light.
//
//   gives    srgb_from_linear
//   needs    nothing: pure functions, no uniforms, no textures
//   units    linear light and encoded values, both 0..1
//   source   IEC 61966-2-1:1999, the exact two-piece curve
//   tested   tests/glsl/test_colour.py, against Python's own curve
#ifndef COLOUR_ENCODE
#define COLOUR_ENCODE

vec3 srgb_from_linear(vec3 linear) {
    vec3 kept = clamp(linear, 0.0, 1.0);
    vec3 low = kept * 12.92;
    vec3 high = 1.055 * pow(kept, vec3(1.0 / 2.4)) - 0.055;
    return mix(high, low, vec3(lessThanEqual(kept, vec3(0.0031308))));
}
#endif
