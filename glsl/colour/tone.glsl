// colour/tone.glsl -- curves that bring bright light into a screen's range.
//
//   gives    tone_reinhard, tone_film
//   needs    colour/luminance.glsl
//   units    linear light in, 0 and up; linear light out, 0..1
//   source   tone_reinhard: Reinhard, Stark, Shirley and Ferwerda 2002, "Photographic Tone
//            Reproduction for Digital Images" (SIGGRAPH), eq. 4, on luminance (Rec. 709
//            weights); tone_film: Narkowicz 2015, "ACES Filmic Tone Mapping Curve", a
//            rational fit to the Academy's reference transform, each channel by itself
//   tested   tests/glsl/test_colour.py: ends, order, and eq. 4 in float64
#ifndef COLOUR_TONE
#define COLOUR_TONE
#include "colour/luminance.glsl"

// Keeps hues; `white` is the luminance that becomes 1.
vec3 tone_reinhard(vec3 light, float white) {
    float before = luminance(light);
    return light * ((1.0 + before / (white * white)) / (1.0 + before));
}

// Darkens darks, rolls bright parts off towards white.
vec3 tone_film(vec3 light) {
    vec3 kept = max(light, 0.0);
    return clamp(kept * (2.51 * kept + 0.03) / (kept * (2.43 * kept + 0.59) + 0.14), 0.0, 1.0);
}
#endif
