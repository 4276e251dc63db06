// foreign/noise.glsl -- random texels, where nothing feeds a channel of another tool's shader.
//
//   gives    channel_texels, four independent numbers a texel, 0..1, encoded for the display
//   needs    noise/hash.glsl
//   units    none
//   source   made here
//   tested   tests/glsl/test_foreign.py, against the statistics of random numbers
#include "noise/hash.glsl"
#pragma kernel(output = "channel_texels:rgba8")

uniform int number = 0;  //! slider(0, 99) Which channel: each has numbers of its own

const uint SALT = 0x5632eb4cu;  // CRC-32 of "foreign/noise"

vec4 kernel(ivec2 texel) {
    uint seed = uint(number) * 2u + SALT;
    return vec4(random_pair(texel, seed), random_pair(texel, seed + 1u));
}
