// texturing/detail.glsl -- a small grey image of fine patterns: cracks, furrows, grains.
//
//   gives    detail: grey, about 0.5; what counts is its ratio to its own mean
//   needs    noise/periodic.glsl
//   units    the tile is 1 wide
//   source   Belaiche 2010, section 2.7: grey, of high frequency, 512 x 512, repeated
//   tested   tests/glsl/test_texturing_detail.py: seamless, grey, no coarse pattern
//
// Only what is finer than about a tenth of the tile: anything coarser would show its repeats
// from afar, where the cover is to be seen and not this.
#include "noise/periodic.glsl"
#pragma kernel(output = "detail:rgba16f")

#include "texturing/parameters/seed.glsl"
uniform float cracks = 0.5;      //! slider(0, 1) step(0.01) How dark cracks are
uniform float roughness = 0.6;   //! slider(0, 1) step(0.01) How uneven the surface is
uniform float furrows = 0.25;    //! slider(0, 1) step(0.01)
                                 //! How deep furrows are, from west to east
uniform float grains = 0.4;      //! slider(0, 1) step(0.01) How strong single grains are

const uint SALT = 0xeac5a27fu;  // CRC-32 of "texturing/detail"

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size);
    uint number = seed * 32u + SALT;
    vec2 bend = vec2(gradient_noise_periodic(place * 20.0, ivec2(20), number),
                     gradient_noise_periodic(place * 20.0, ivec2(20), number + 1u));
    vec3 pieces = cells_periodic(place * 13.0 + 0.5 * bend, ivec2(13), number + 2u);
    float crack = 1.0 - smoothstep(0.0, 0.10, pieces.y - pieces.x);
    float rough = gradient_fbm_periodic(place * 16.0, ivec2(16), 5, 0.8, number + 4u);
    float furrow = abs(gradient_noise_periodic(place * vec2(9.0, 60.0) + 0.4 * bend, ivec2(9, 60),
                                               number + 10u));
    float grain = value_noise_periodic(place * 90.0, ivec2(90), number + 11u) - 0.5;
    float level = 0.5 * (1.0 + 0.12 * (pieces.z - 0.5) + 3.4 * roughness * rough
                         + furrows * (1.2 * furrow - 0.25) + grains * 0.6 * grain);
    level = mix(level, 0.12, 0.85 * cracks * crack);
    return vec4(vec3(clamp(level, 0.02, 1.0)), 1.0);
}
