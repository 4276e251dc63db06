// texturing/snow.glsl -- a seamless tile of snow: drifts laid by the wind, furrows, grains.
//
//   gives    colour, linear light
//   needs    noise/periodic.glsl
//   units    the tile is 1 wide; drifts are counted across it
//   source   made here; the thesis (Belaiche 2010, section 2.3) takes a photograph
//   tested   tests/glsl/test_base_textures.py: seamless, its mean colour, its seeds
//
// Fresh snow throws back nine tenths of the light, so there is little room above its mean:
// everything here is a shallow hollow, bluish, because a hollow is lit by the sky.
#include "noise/periodic.glsl"
#pragma kernel(output = "colour:rgba16f")

#include "texturing/parameters/seed.glsl"
uniform int drifts = 6;                       //! slider(1, 64) Drifts across the tile
uniform vec3 tint = vec3(0.84, 0.86, 0.88);     //! colour Snow in the light
uniform vec3 shade = vec3(0.50, 0.58, 0.70);    //! colour The depth of a hollow
uniform float ripples = 0.4;                  //! slider(0, 1) step(0.01)
                                              //! How much the wind has furrowed it
uniform float grain = 0.3;                    //! slider(0, 1) step(0.01)
                                              //! How coarse it looks close up

const uint SALT = 0xc6a62e90u;  // CRC-32 of "texturing/snow"

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size) * float(drifts);
    ivec2 period = ivec2(drifts);
    uint number = seed * 32u + SALT;
    float drift = gradient_fbm_periodic(place, period, 5, 0.65, number);
    // Furrows lie along the wind: six times as many across it; the drifts turn them a little.
    vec2 bent = place + vec2(0.15, 0.35) * drift;
    float furrow = gradient_fbm_periodic(bent * vec2(2.0, 12.0), period * ivec2(2, 12), 4, 0.6,
                                         number + 6u);
    // abs() folds the noise: crests are sharp, hollows round.
    float crest = 1.0 - abs(furrow) * 2.2;
    float sheltered = smoothstep(-0.3, 0.3, -drift);
    float speck = value_noise_periodic(place * 40.0, period * 40, number + 12u)
                * value_noise_periodic(place * 23.0, period * 23, number + 13u);
    float hollow = 0.30 * sheltered + ripples * (0.35 + 0.65 * sheltered) * (1.0 - crest * crest)
            + grain * 0.8 * (speck - 0.25);
    return vec4(mix(tint, shade, clamp(hollow, 0.0, 1.0)), 1.0);
}
