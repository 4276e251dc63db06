// texturing/mud.glsl -- a seamless tile of mud: clods, wet hollows, and cracks where it has dried.
//
//   gives    colour, linear light
//   needs    noise/periodic.glsl
//   units    the tile is 1 wide; clods are counted across it
//   source   made here: Belaiche 2010, section 2.3, takes photographs; section 2.5 wants mud
//            on the plateaus
//   tested   tests/glsl/test_base_textures.py: seamless, its mean colour, its seeds
//
// One field of heights decides all: the low parts are wet, so darker and smoother; the high
// ones dry out, pale, and crack. Colour alone is given: a shine would need an eye.
#include "noise/periodic.glsl"
#pragma kernel(output = "colour:rgba16f")

#include "texturing/parameters/seed.glsl"
uniform int clods = 6;                        //! slider(1, 64) Clods across the tile
uniform vec3 tint = vec3(0.185, 0.122, 0.070);  //! colour Mud that is drying
uniform vec3 wet = vec3(0.058, 0.037, 0.021);   //! colour Wet mud
uniform float wetness = 0.4;                  //! slider(0, 1) step(0.01) How much of it is wet
uniform float cracks = 0.5;                   //! slider(0, 1) step(0.01)
                                              //! How dark the cracks in dry mud are
uniform float roughness = 0.6;                //! slider(0, 1) step(0.01) How lumpy it is

const uint SALT = 0x8dc1ce03u;  // CRC-32 of "texturing/mud"

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size) * float(clods);
    ivec2 period = ivec2(clods);
    uint number = seed * 32u + SALT;
    vec2 bend = vec2(gradient_fbm_periodic(place * 2.0, period * 2, 3, 0.5, number),
                     gradient_fbm_periodic(place * 2.0, period * 2, 3, 0.5, number + 4u));
    vec2 bent = place + 0.35 * bend;
    // Folded noise: round clods with creases between them, the smaller on the larger.
    float broad = gradient_fbm_periodic(place, period, 4, 0.5, number + 8u);
    float lump = abs(gradient_noise_periodic(bent * 2.0, period * 2, number + 12u))
               + 0.6 * abs(gradient_noise_periodic(bent * 4.0, period * 4, number + 13u))
               + 0.4 * abs(gradient_noise_periodic(bent * 8.0, period * 8, number + 14u));
    float grit = gradient_fbm_periodic(place * 16.0, period * 16, 4, 0.75, number + 15u);
    float level = 0.5 + 1.2 * broad + roughness * (0.8 * lump - 0.32);
    float dry = smoothstep(0.25, 0.80, level + 0.10 * grit + 0.5 - wetness);
    // Pieces of a crust, each a little lighter or darker than the next.
    vec3 piece = cells_periodic(bent * 3.0, period * 3, number + 20u);
    float crack = 1.0 - smoothstep(0.01, 0.09 + 0.08 * grit, piece.y - piece.x);
    // Creases see less of the sky than what bulges.
    float bulge = clamp(0.45 + 1.5 * lump, 0.4, 1.5);
    float uneven = mix(1.0, bulge, roughness) * (1.0 + roughness * 1.3 * grit);
    vec3 crust = tint * (1.0 + 0.35 * (piece.z - 0.5) * dry) * uneven;
    vec3 soaked = wet * mix(1.0, uneven, 0.7);
    vec3 colour = mix(soaked, crust, dry);
    // Only the driest parts have cracked.
    float cracked = cracks * crack * smoothstep(0.45, 0.95, dry);
    colour = mix(colour, 0.55 * wet, clamp(cracked, 0.0, 1.0));
    return vec4(clamp(colour, vec3(0.004), vec3(1.0)), 1.0);
}
