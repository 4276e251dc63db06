// texturing/grass.glsl -- a seamless tile of grass: blades over blades, in clumps.
//
//   gives    colour, linear light
//   needs    noise/periodic.glsl
//   units    the tile is 1 wide; blades are counted across it
//   source   made here; the thesis (Belaiche 2010, section 2.3) takes a photograph
//   tested   tests/glsl/test_base_textures.py: seamless, its mean colour, its seeds
//
// Every cell of a lattice grows one blade, a line that thins towards its tip. Where blades
// cross, the taller hides the other, and the deeper is darker. Two lattices of different
// fineness, so that neither shows.
#include "noise/periodic.glsl"
#pragma kernel(output = "colour:rgba16f")

#include "texturing/parameters/seed.glsl"
uniform int blades = 44;                      //! slider(4, 200) Blades across the tile
uniform int clumps = 5;                       //! slider(1, 32) Clumps across the tile
uniform vec3 tint = vec3(0.120, 0.165, 0.034);  //! colour A blade in the light
uniform vec3 dry = vec3(0.235, 0.205, 0.075);   //! colour A dry blade
uniform vec3 shade = vec3(0.026, 0.038, 0.010); //! colour The ground between the blades
uniform float variety = 0.5;                  //! slider(0, 1) step(0.01)
                                              //! How much blades and clumps differ

const uint SALT = 0x0a9acb0au;  // CRC-32 of "texturing/grass"

// How high the tallest blade is over a place (0: no blade), how dry it is, how far along it
// is.
vec3 tallest(vec2 place, ivec2 period, uint number, float blur) {
    vec3 found = vec3(0.0);
    ivec2 low = ivec2(floor(place));
    // A blade is at most 1.6 cells long: two cells each way reach every blade.
    for (int y = -2; y <= 2; y++) {
        for (int x = -2; x <= 2; x++) {
            ivec2 cell = low + ivec2(x, y);
            ivec2 key = lattice_wrapped(cell, period);
            vec2 root = vec2(cell) + random_pair(key, number);
            vec2 chance = random_pair(key, number + 1u);
            float angle = 6.2831853 * chance.x;
            float reach = 0.7 + 0.9 * random(key, number + 2u);
            vec2 along = vec2(cos(angle), sin(angle)) * reach;
            vec2 offset = place - root;
            float share = clamp(dot(offset, along) / (reach * reach), 0.0, 1.0);
            float aside = length(offset - along * share);
            float width = 0.21 * (1.0 - 0.85 * share * share);
            float cover = clamp((width - aside) / blur + 0.5, 0.0, 1.0);
            // Blades rise from their roots, some higher than others.
            float height = cover * (0.25 + 0.45 * share + 0.3 * chance.y);
            if (height > found.x) found = vec3(height, random(key, number + 3u), share);
        }
    }
    return found;
}

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size);
    uint number = seed * 16u + SALT;
    ivec2 coarse = ivec2(blades);
    ivec2 fine = ivec2(blades + blades / 2 + 1);
    // A blade's edge is never sharper than a texel.
    vec3 front = tallest(place * vec2(coarse), coarse, number,
                         float(blades) / float(min(size.x, size.y)) + 0.02);
    vec3 behind = tallest(place * vec2(fine), fine, number + 4u,
                          float(fine.x) / float(min(size.x, size.y)) + 0.02);
    vec3 blade = front.x > 0.35 * behind.x ? front : vec3(0.75 * behind.x, behind.yz);
    float clump = gradient_fbm_periodic(place * float(clumps), ivec2(clumps), 4, 0.55,
                                        number + 8u);
    float dryness = smoothstep(0.55, 1.0, blade.y + variety * (0.9 * clump - 0.1));
    vec3 leaf = mix(tint, dry, dryness) * (1.0 + variety * (0.7 * (blade.y - 0.5) + 0.9 * clump));
    return vec4(mix(shade, leaf, smoothstep(0.05, 0.95, blade.x)), 1.0);
}
