// texturing/path.glsl -- a seamless tile of a path: stones of three sizes trodden into earth.
//
//   gives    colour, linear light
//   needs    noise/periodic.glsl
//   units    the tile is 1 wide; the largest stones are counted across it
//   source   made here: Belaiche 2010, section 2.3, takes photographs; section 2.5 wants a
//            texture for paths
//   tested   tests/glsl/test_base_textures.py: seamless, its mean colour, its seeds
//
// Every cell of a lattice holds one stone or none: an egg, turned by chance, dented by
// noise. Smaller stones lie between the larger. Around each the earth is darker, where the
// stone keeps the light of the sky away. No light falls from a side.
#include "noise/periodic.glsl"
#pragma kernel(output = "colour:rgba16f")

#include "texturing/parameters/seed.glsl"
uniform int stones = 14;                      //! slider(2, 60) The largest stones across the tile
uniform vec3 tint = vec3(0.235, 0.170, 0.110);  //! colour Trodden earth
uniform vec3 stone = vec3(0.330, 0.300, 0.260); //! colour A pale stone
uniform vec3 shade = vec3(0.060, 0.042, 0.028); //! colour The earth beside a stone
uniform float gravel = 0.6;                   //! slider(0, 1) step(0.01) How many stones there are
uniform float roughness = 0.5;                //! slider(0, 1) step(0.01)
                                              //! How uneven earth and stones are

const uint SALT = 0xfb71002cu;  // CRC-32 of "texturing/path"

// The stone that reaches a place best: how far inside its rim that is, over its radius (below 0:
// outside), and a random number of it.
vec2 nearest_stone(vec2 place, ivec2 period, float share, uint number) {
    vec2 found = vec2(-1e3, 0.0);
    ivec2 low = ivec2(floor(place));
    for (int y = -1; y <= 1; y++) {
        for (int x = -1; x <= 1; x++) {
            ivec2 cell = low + ivec2(x, y);
            ivec2 key = lattice_wrapped(cell, period);
            vec2 chance = random_pair(key, number);
            vec2 shape = random_pair(key, number + 1u);
            vec2 middle = vec2(cell) + 0.25 + 0.5 * random_pair(key, number + 2u);
            float angle = 6.2831853 * shape.x;
            vec2 along = vec2(cos(angle), sin(angle));
            vec2 offset = place - middle;
            vec2 turned = vec2(dot(offset, along), dot(offset, vec2(-along.y, along.x)));
            float radius = mix(0.22, 0.46, chance.y);
            // An egg: slimmer towards one end.
            turned.y *= 1.15 + 0.55 * shape.y + 0.35 * turned.x / radius;
            float inside = 1.0 - length(turned) / radius;
            if (chance.x < share && inside > found.x) {
                found = vec2(inside, random(key, number + 3u));
            }
        }
    }
    return found;
}

// A layer of stones over what is there.
vec3 with_stones(vec3 ground, vec2 place, int across, float share, float dent, float grit,
                 float blur, uint number) {
    vec2 nearest = nearest_stone(place * float(across), ivec2(across), share, number);
    float inside = nearest.x + dent;
    // Earth beside a stone is darker, up to a third of a radius away.
    vec3 surround = mix(ground, shade, 0.7 * smoothstep(-0.35, 0.0, inside));
    float tone = 0.62 + 0.75 * nearest.y;
    vec3 hue = mix(stone, tint * 1.25, 0.6 * fract(nearest.y * 7.0));
    // A stone's top sees the whole sky, its rim half of it; half sunk, it is dusty there.
    vec3 top = hue * tone * (0.62 + 0.38 * smoothstep(0.0, 0.55, inside))
            * (1.0 + roughness * 0.9 * grit);
    return mix(surround, top, smoothstep(-blur, blur, inside));
}

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size);
    uint number = seed * 64u + SALT;
    ivec2 coarse = ivec2(5);
    float broad = gradient_fbm_periodic(place * vec2(coarse), coarse, 5, 0.6, number);
    ivec2 fine = ivec2(max(stones * 3, 16));
    float dent = gradient_fbm_periodic(place * vec2(fine), fine, 3, 0.5, number + 6u);
    float grit = gradient_fbm_periodic(place * vec2(fine * 2), fine * 2, 4, 0.75, number + 10u);
    vec3 colour = tint * (1.0 + 0.75 * broad + roughness * 1.5 * grit);
    // A rim is never sharper than a texel.
    float texels = float(min(size.x, size.y));
    float sharp = 2.5 * float(stones) / texels;
    float trodden = 0.55 + 0.9 * broad;
    colour = with_stones(colour, place, stones * 4, gravel * (0.45 + trodden * 0.5), 0.25 * dent,
                         grit, 4.0 * sharp + 0.05, number + 16u);
    colour = with_stones(colour, place, stones * 2, gravel * 0.75 * trodden, 0.35 * dent, grit,
                         2.0 * sharp + 0.04, number + 24u);
    colour = with_stones(colour, place, stones, gravel * 0.55 * trodden, 0.45 * dent, grit,
                         sharp + 0.03, number + 32u);
    return vec4(clamp(colour, vec3(0.004), vec3(1.0)), 1.0);
}
