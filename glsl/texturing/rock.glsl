// texturing/rock.glsl -- a seamless tile of rock: weathered faces, cracks between them.
//
//   gives    colour, linear light
//   needs    noise/periodic.glsl
//   units    the tile is 1 wide; blocks are counted across it
//   source   made here; the thesis (Belaiche 2010, section 2.3) takes a photograph
//   tested   tests/glsl/test_base_textures.py: seamless, its mean colour, its seeds
//
// The place is bent by noise before anything is looked up, or the blocks' straight edges
// would look laid by a mason. Hollows are darker than what protrudes: they see less sky.
// No light falls from a side; that is for the lighting stage.
#include "noise/periodic.glsl"
#pragma kernel(output = "colour:rgba16f")

#include "texturing/parameters/seed.glsl"
uniform int blocks = 6;                       //! slider(1, 64) Blocks across the tile
uniform vec3 tint = vec3(0.27, 0.245, 0.215);   //! colour A face in the light
uniform vec3 stain = vec3(0.19, 0.145, 0.10);   //! colour Weathered faces
uniform vec3 shade = vec3(0.035, 0.031, 0.029); //! colour The depth of a crack
uniform float cracks = 0.6;                   //! slider(0, 1) step(0.01) How dark the cracks are
uniform float roughness = 0.6;                //! slider(0, 1) step(0.01) How uneven the faces are

const uint SALT = 0xc76c3081u;  // CRC-32 of "texturing/rock"

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size) * float(blocks);
    ivec2 period = ivec2(blocks);
    uint number = seed * 32u + SALT;
    vec2 bend = vec2(gradient_fbm_periodic(place, period, 5, 0.6, number),
                     gradient_fbm_periodic(place, period, 5, 0.6, number + 6u));
    vec2 bent = place + 0.85 * bend;
    vec3 large = cells_periodic(bent, period, number + 12u);
    vec3 small = cells_periodic(bent * 3.0 + bend, period * 3, number + 14u);
    // Near a border between two cells the nearest and the second nearest points are equally far.
    float crack = 1.0 - smoothstep(0.0, 0.16, large.y - large.x);
    float split = 1.0 - smoothstep(0.0, 0.20, small.y - small.x);
    float grain = gradient_fbm_periodic(bent * 4.0, period * 4, 6, 0.72, number + 16u);
    float ridge = 1.0 - abs(gradient_fbm_periodic(bent * 2.0, period * 2, 5, 0.5, number + 22u))
            * 3.2;
    float patches = gradient_fbm_periodic(place, period, 4, 0.5, number + 27u);
    float weathered = smoothstep(-0.15, 0.25, patches + 0.25 * (large.z - 0.5));
    vec3 face = mix(tint, stain, 0.75 * weathered);
    face *= 1.0 + 0.30 * (large.z - 0.5) + 0.25 * (small.z - 0.5);
    float relief_of_face = roughness * (1.7 * grain + 0.35 * (ridge - 0.6));
    face *= clamp(1.0 + relief_of_face, 0.25, 1.8);
    float depth = cracks * max(crack * (0.75 + 0.5 * grain), 0.55 * split);
    return vec4(mix(face, shade, clamp(depth, 0.0, 1.0)), 1.0);
}
