// colour/luminance.glsl -- how bright a colour is.
//
//   gives    luminance
//   needs    nothing: pure functions, no uniforms, no textures
//   units    colours linear, of sRGB's primaries; as much for white as each of its parts
//   source   ITU-R BT.709-6, table 3, item 3.2
//   tested   tests/glsl/test_colour.py, against the primaries' places in float64
#ifndef COLOUR_LUMINANCE
#define COLOUR_LUMINANCE

float luminance(vec3 colour) { return dot(colour, vec3(0.2126, 0.7152, 0.0722)); }
#endif
