// foreign/spectrum.glsl -- the sound of a small band, where nothing feeds a sound's channel.
//
//   gives    channel_texels, grey, 0..1: one column a frequency, or one a sample
//   needs    noise/hash.glsl
//   units    seconds; the width is 11025 Hz, and as many samples of 44100 a second
//   source   made here
//   tested   tests/glsl/test_foreign.py: its beat, its tones, and that numbers differ
//
// A channel's lower half of the rows is the spectrum, its upper half the wave, as Shadertoy has
// them in 512 x 2 texels. A drum strikes on each beat and three voices change their tones with
// it: all of it is a function of the time.
#include "noise/hash.glsl"
#pragma kernel(output = "channel_texels:rgba16f")

uniform int content = 2;  //! menu("spectrum", "waves", "channel") What the texels are
uniform int number = 0;   //! slider(0, 99) Which band: each has a tempo and tones of its own
uniform float strength = 1.0;  //! log_slider(0.001, 1) What the loudest tone of the spectrum is

const uint SALT = 0x4c0d55f1u;  // CRC-32 of "foreign/spectrum"
const float HIGHEST = 11025.0;  // [Hz] at the east edge
const float RATE = 44100.0;     // [Hz] of the samples of the wave
const int VOICES = 3;
const int HARMONICS = 5;

uint band_seed() { return uint(number) + SALT; }

float tempo() { return 1.6 + 0.8 * random(ivec2(0), band_seed()); }  // beats a second

// A whole number of Hz, so that a phase needs no more than the second's fraction.
float tone(int voice, int beat) {
    float octaves = 3.5 * random(ivec2(voice + 1, beat), band_seed());
    return floor(110.0 * exp2(octaves));
}

// How strong a drum is, 0..1, so many beats after it was struck.
float strike(float since) { return exp(-6.0 * since) * smoothstep(0.0, 0.03, since); }

float spectrum_at(float hertz, int beat, float since) {
    float level = 0.12 * exp(-hertz / 4000.0);
    level += strike(since) * exp(-hertz / 160.0);
    for (int voice = 0; voice < VOICES; ++voice) {
        for (int harmonic = 1; harmonic <= HARMONICS; ++harmonic) {
            float detuning = (hertz - tone(voice, beat) * float(harmonic)) / 45.0;
            level += (0.75 - 0.3 * since) / sqrt(float(harmonic)) * exp(-detuning * detuning);
        }
    }
    return level;
}

float wave_at(float seconds, int beat, float since) {
    float turn = 6.2831853;
    float found = strike(since) * sin(turn * fract(60.0 * seconds));
    for (int voice = 0; voice < VOICES; ++voice) {
        float hertz = tone(voice, beat);
        for (int harmonic = 1; harmonic <= HARMONICS; ++harmonic) {
            float phase = fract(hertz * float(harmonic) * seconds);
            found += 0.4 * (0.75 - 0.3 * since) / float(harmonic) * sin(turn * phase);
        }
    }
    return found;
}

float spectrum_or_wave(ivec2 texel) {
    float beats = time * tempo();
    int beat = int(floor(beats));
    float since = beats - floor(beats);
    if (content == 0 || (content == 2 && 2 * texel.y < size.y)) {
        float hertz = (float(texel.x) + 0.5) / float(size.x) * HIGHEST;
        return strength * clamp(spectrum_at(hertz, beat, since), 0.0, 1.0);
    }
    float seconds = fract(time) + float(texel.x) / RATE;
    return clamp(0.5 + 0.25 * wave_at(seconds, beat, since), 0.0, 1.0);
}

vec4 kernel(ivec2 texel) { return vec4(vec3(spectrum_or_wave(texel)), 1.0); }
