// generation/normalise/apply.glsl -- heights moved and stretched by a range that is known.
//
//   gives    height: as it is, highest at 1, or lowest at 0 and highest at 1
//   needs    terrain/extremes.glsl
//   units    heights without unit; the range in the same
//   source   Belaiche 2010, section 4.3.1 ("Normalisation": h 256 / max)
//   tested   tests/glsl/test_filters.py, against NumPy
//
// The thesis multiplies by 256 for bytes, which reaches 256 and wraps; here the highest is 1.
// A flat terrain, roundings apart, has no range to stretch: it becomes 0 by "minmax", and stays by
// "max" unless it is above 0. A terrain wholly below 0 stays by "max", for division would
// put it upside down.
#include "terrain/extremes.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D height; //! input
uniform sampler2D range;  //! input
uniform int mode = 2;     //! menu("none", "max", "minmax") label("Normalise") What is stretched to
                          //! 1: nothing, the highest, or lowest to highest

float kernel(ivec2 texel) {
    float h = texelFetch(height, texel, 0).r;
    if (mode == 0) return h;
    vec2 found = texelFetch(range, ivec2(0), 0).rg;
    float low = mode == 1 ? 0.0 : found.x;
    float span = span_of(vec2(low, found.y));
    if (span == 0.0) return mode == 1 ? h : 0.0;
    float share = (h - low) / span;
    return mode == 1 ? share : clamp(share, 0.0, 1.0);
}
