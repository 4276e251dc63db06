// foreign/spectrum.glsl -- a made-up sound, where nothing feeds a sound to another tool's shader.
//
//   gives    channel_texels, grey, 0..1: one column a frequency, or one a sample
//   needs    nothing
//   units    seconds
//   source   made here
//   tested   tests/glsl/test_foreign.py: it is a function of time, bounded, the waves around one half
//
// Frequencies go from 0 in the west to the highest in the east. Eight bands swell and fade, each in
// a time of its own, and high ones are weaker than low ones, as in music. The waves are two tones
// that beat. Rows are channels of a sound: all are the same; `channel` is Shadertoy's, the spectrum in
// the lower half, the waves in the upper one.
#pragma kernel(output = "channel_texels:rgba16f")

uniform int content = 0;  //! menu("spectrum", "waves", "channel") What the texels are

float spectrum(float place) {
    float band = floor(place * 8.0);
    float swell = 0.5 + 0.5 * sin(time * (1.0 + 0.37 * band) + 2.4 * band);
    float inside = fract(place * 8.0);
    return (0.25 + 0.75 * swell) * (1.0 - 0.8 * place) * 4.0 * inside * (1.0 - inside);
}

float wave(float place) {
    float tone = sin(6.2831853 * (5.0 * place + time)) + sin(6.2831853 * (7.0 * place - 0.6 * time));
    return 0.5 + 0.22 * tone;
}

vec4 kernel(ivec2 texel) {
    float place = (float(texel.x) + 0.5) / float(size.x);
    bool is_spectrum = content == 0 || (content == 2 && texel.y * 2 < size.y);
    return vec4(vec3(is_spectrum ? spectrum(place) : wave(place)), 1.0);
}
