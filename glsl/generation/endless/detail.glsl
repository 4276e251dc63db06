// generation/endless/detail.glsl -- the one detail component of an endless terrain, a tile.
//
//   gives    detail, 0..1
//   needs    noise/periodic.glsl
//   units    heights without unit
//   source   Belaiche 2010, section 5.6: one component of detail is made, once, from layers
//   tested   tests/glsl/test_endless.py, against a twin in float64, and against its own copy
//
// A tile that fits beside its copy. It reads nothing of any part, so no part makes it anew.
#include "noise/periodic.glsl"
#pragma kernel(output = "detail:r32f", warns = "\
    frequency * 2 ** octaves > size.x: \
    the last layer has less than two texels a cell (lower frequency or octaves)")

uniform int frequency = 6;         //! log_slider(1, 64) Cells along a side in the first layer
uniform int octaves = 6;           //! slider(1, 8) Layers, each twice as fine as the one before
uniform float gain = 0.45;         //! slider(0, 1) step(0.01) Height of each layer over the one
                                   //! before
uniform int form = 1;              //! menu("plain", "ridged") Hills as they come, or creased along
                                   //! their zeros
uniform uint seed = 7u;            //! slider(0, 9999) Which terrain

const uint SALT = 0x70a3c1cbu;  // CRC-32 of "generation/endless/detail"

float kernel(ivec2 texel) {
    // The texel after the last one is the first again.
    vec2 place = vec2(texel) / vec2(size) * float(frequency);
    ivec2 period = ivec2(frequency);
    float total = 0.0;
    float strengths = 0.0;
    float strength = 1.0;
    for (int k = 0; k < octaves; k++) {
        // Moved by uneven parts of a cell: else all layers were zero at the points of the first.
        vec2 moved = place + float(k) * vec2(0.618, 0.382);
        float noise = gradient_noise_periodic(moved, period, seed + SALT + uint(k) * 101u);
        float crest = 1.0 - abs(noise);
        total += strength * (form == 1 ? crest * crest : 0.5 + 0.5 * noise);
        strengths += strength;
        strength *= gain;
        place *= 2.0;
        period *= 2;
    }
    return total / strengths;
}
