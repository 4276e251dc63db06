// foreign/colour.glsl -- another tool's picture as a terrain's colour, in linear light.
//
//   gives    colour
//   needs    nothing
//   units    encoded values in, linear light out
//   source   IEC 61966-2-1:1999, the inverse of colour/encode.glsl
//   tested   tests/glsl/test_foreign_terrain.py, against Python's own curve
//
// Such tools make what a screen shows; a terrain is lit in linear light, and encoded once at the
// end. Where the picture has another size, each texel takes the nearest one.
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D picture;  //! input

vec4 kernel(ivec2 texel) {
    ivec2 shown = textureSize(picture, 0);
    vec2 place = (vec2(texel) + 0.5) * vec2(shown) / vec2(size);
    vec3 encoded = max(texelFetch(picture, min(ivec2(place), shown - 1), 0).rgb, 0.0);
    vec3 low = encoded / 12.92;
    vec3 high = pow((encoded + 0.055) / 1.055, vec3(2.4));
    return vec4(mix(high, low, vec3(lessThanEqual(encoded, vec3(0.04045)))), 1.0);
}
