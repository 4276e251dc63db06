// texturing/sand.glsl -- a seamless tile of sand: ripples across the wind, hollows, grains.
//
//   gives    colour, linear light
//   needs    noise/periodic.glsl
//   units    the tile is 1 wide; ripples are counted across it, from south to north
//   source   made here: Belaiche 2010, section 2.3, takes photographs
//   tested   tests/glsl/test_base_textures.py: seamless, its mean colour, its seeds
//
// Ripples of the wind rise gently and fall steeply, and they fork. So there are two trains
// of them, one with a few ripples more than the other: where chance passes from the one to
// the other, crests split. No light falls from a side; troughs are darker and hold coarser,
// darker grains, as they do on a beach.
#include "noise/periodic.glsl"
#pragma kernel(output = "colour:rgba16f")

#include "texturing/parameters/seed.glsl"
uniform int ripples = 22;                     //! slider(2, 100) Ripples across the tile
uniform vec3 tint = vec3(0.520, 0.385, 0.225);  //! colour Dry sand on a crest
uniform vec3 shade = vec3(0.270, 0.175, 0.090); //! colour The depth of a trough
uniform float height = 0.7;                   //! slider(0, 1) step(0.01)
                                              //! How much the wind has rippled it
uniform float grain = 0.5;                    //! slider(0, 1) step(0.01)
                                              //! How coarse it looks close up

const uint SALT = 0x505f1932u;  // CRC-32 of "texturing/sand"

// One ripple, 0 in the trough and 1 on the crest: three quarters of it rise.
float ripple(float phase) {
    float along = fract(phase);
    float side = along < 0.75 ? along / 0.75 : (1.0 - along) / 0.25;
    return side * side * (3.0 - 2.0 * side);
}

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size);
    uint number = seed * 32u + SALT;
    ivec2 period = ivec2(5);
    float bend = gradient_fbm_periodic(place * vec2(4.0, 6.0), ivec2(4, 6), 3, 0.5, number);
    float sway = gradient_fbm_periodic(place * 2.0, ivec2(2), 2, 0.5, number + 4u);
    float across = place.y + 0.11 * bend + 0.16 * sway;
    // Whole turns over the tile, also eastwards, or it would not meet its copy.
    float fewer = ripple(float(ripples) * across + place.x);
    float more = ripple(float(ripples + max(ripples / 5, 1)) * across + place.x + 0.5);
    float passing = gradient_fbm_periodic(place * 3.0, ivec2(3), 2, 0.5, number + 8u);
    float crest = mix(fewer, more, smoothstep(-0.05, 0.05, passing));
    // Here and there the ground lies smooth.
    float patches = gradient_fbm_periodic(place * vec2(period), period, 4, 0.5, number + 12u);
    float strength = height * smoothstep(-0.35, 0.15, patches + 0.12);
    float hollow = 0.12 + strength * (0.62 * (1.0 - crest) - 0.05) - 0.22 * patches;
    ivec2 grains = ivec2(96);
    float fine = value_noise_periodic(place * vec2(grains) * 2.0, grains * 2, number + 18u);
    float coarse = value_noise_periodic(place * vec2(grains), grains, number + 19u);
    float speck = 0.5 * (fine + coarse) - 0.5;
    hollow += grain * 0.30 * speck;
    vec3 colour = mix(tint, shade, clamp(hollow, 0.0, 1.0));
    // A few dark grains, gathered in the troughs, and a few that glitter.
    float chance = cells_periodic(place * 220.0, ivec2(220), number + 20u).z;
    float dark = smoothstep(0.975 - 0.05 * hollow, 1.0, chance);
    colour *= 1.0 - grain * 0.55 * dark;
    colour *= 1.0 + grain * 0.35 * smoothstep(0.985, 1.0, 1.0 - chance);
    return vec4(min(colour, vec3(1.0)), 1.0);
}
