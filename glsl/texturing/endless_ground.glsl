// texturing/endless_ground.glsl -- meadow, wood, rock, sand and snow on endless terrain.
//
//   gives    colour, linear light
//   needs    terrain/heightfield.glsl, terrain/parts.glsl, noise/hash.glsl; a height 0..1
//   units    heights in metres above sea level, slopes in degrees, patches in texels of the height
//   source   made here: weights by height and slope, moved by noise that knows nodes and not parts
//   tested   tests/glsl/test_endless.py: weights sum to 1, and borders agree to the last bit
//
// What repeats over a part's texture would not fit beside the next part's, so everything that
// varies here is a function of the node's own number.
#include "noise/hash.glsl"
#include "terrain/heightfield.glsl"
#include "terrain/parts.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D height;           //! input
uniform ivec2 part = ivec2(0);      //! parts("east", "north")
                                    //! Which part of the terrain, counted east and north
uniform int apron = 0;              //! slider(0, 1024) unit("texels")
                                    //! Of the neighbours, so much around the part, in texels of
                                    //! the height
uniform int patches = 64;           //! log_slider(4, 1024) unit("texels")
                                    //! Width of the widest patches
uniform uint seed = 7u;             //! slider(0, 9999) Which patches
uniform float sand_below = 12.0;    //! slider(-500, 9000) step(1) unit("m") group("Heights")
                                    //! The shore reaches up to here
uniform float wood_below = 620.0;   //! slider(-500, 9000) step(1) unit("m") group("Heights")
                                    //! Trees grow up to here
uniform float snow_from = 1000.0;   //! slider(-500, 9000) step(1) unit("m") group("Heights")
                                    //! Snow lies from here up
uniform float bare_from = 30.0;     //! slider(0, 90) step(1) unit("degrees") group("Heights")
                                    //! Steeper than this, rock shows
uniform float ragged = 140.0;       //! slider(0, 1000) step(1) unit("m") group("Heights")
                                    //! How far the patches move those heights
uniform vec3 meadow = vec3(0.120, 0.135, 0.048);  //! colour group("Colours") Grass
uniform vec3 wood = vec3(0.036, 0.056, 0.026);    //! colour group("Colours") Trees
uniform vec3 rock = vec3(0.205, 0.180, 0.155);    //! colour group("Colours") Rock
uniform vec3 sand = vec3(0.420, 0.360, 0.240);    //! colour group("Colours") Sand
uniform vec3 snow = vec3(0.800, 0.840, 0.900);    //! colour group("Colours") Snow
uniform float contrast = 0.35;      //! slider(0, 1) step(0.01) group("Colours")
                                    //! How much lighter and darker all of them become in patches
uniform int shown = 0;              //! menu("colours", "weights") group("Colours")
                                    //! The ground, or what each colour counts: rock red, wood
                                    //! green, snow blue

const uint SALT = 0xd657708du;  // CRC-32 of "texturing/endless_ground"

// A random number at each point of a lattice, -1..1, smooth between them.
float patch_at(ivec2 cell, vec2 share, uint which) {
    share = share * share * (3.0 - 2.0 * share);
    vec4 corner = vec4(random_signed(cell, which), random_signed(cell + ivec2(1, 0), which),
                       random_signed(cell + ivec2(0, 1), which), random_signed(cell + 1, which));
    return bilinear(corner, share);
}

// Patches of every width from the widest down to two texels, each half as wide and 0.65 as
// strong as the one before: all of them in x, and in y those from the fourth on, as strong as
// the first ones were.
vec2 patches_at(ivec2 node, int widest, uint which) {
    vec2 share;
    ivec2 cell = cell_of(node, widest, share);
    // One division finds all lattices, for each has half the width of the one before.
    share *= float(widest);
    vec2 total = vec2(0.0);
    float strength = 0.35;
    float wide = float(widest);
    int k = 0;
    do {
        // Moved by half a cell: points of one lattice and of the one before never meet.
        vec2 place = share / wide + 0.5 * float(k);
        vec2 low = floor(place);
        float found = strength * patch_at((cell << k) + ivec2(low), place - low, which + uint(k));
        total += vec2(found, k < 3 ? 0.0 : found / (0.65 * 0.65 * 0.65));
        strength *= 0.65;
        wide *= 0.5;
        k++;
    } while (wide >= 2.0 && k < 8);
    return total;
}

// Soft from 0 to 1 around a level, over so much to each side.
float over(float value, float level, float soft) {
    float t = clamp(0.5 + 0.5 * (value - level) / soft, 0.0, 1.0);
    return t * t * (3.0 - 2.0 * t);
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    float metres = base_elevation + relief * height_at(height, place);
    if (isnan(metres)) metres = 0.0;
    vec2 spacing_of_heights = spacing_of(grid, extent);
    vec2 rise = relief * slope_at(height, place, spacing_of_heights, CENTRAL_DIFFERENCES);
    float slope = degrees(atan(length(rise)));
    int finer = max((size.x - 1) / max(grid.x - 1, 1), 1);
    ivec2 node = node_of(texel, part, apron * finer, size);
    vec2 both = patches_at(node, max(patches * finer, 2), seed * 31u + SALT);
    float broad = both.x;
    float fine = both.y;
    float level = metres + ragged * broad;

    // Each takes from all that were before it, so weights sum to 1.
    float woods = over(0.55 * broad + 0.9 * fine, 0.02, 0.16)
            * (1.0 - over(level, wood_below, 90.0));
    float rocks = max(over(slope + 16.0 * fine, bare_from, 5.0),
                      over(level + 250.0 * fine, 0.5 * (wood_below + snow_from), 140.0) * 0.75);
    float sands = 1.0 - over(metres + 14.0 * fine, sand_below, 7.0);
    float snows = over(level + 120.0 * fine, snow_from, 60.0)
            * (1.0 - over(slope, bare_from + 14.0, 7.0));
    if (shown == 1) {
        float cover = 1.0 - snows;
        float bare = rocks * (1.0 - sands) * cover;
        return vec4(bare, woods * (1.0 - rocks) * (1.0 - sands) * cover, snows, 1.0);
    }
    vec3 ground = mix(meadow, wood, woods);
    ground = mix(ground, rock, rocks);
    ground = mix(ground, sand, sands);
    ground *= clamp(1.0 + contrast * (0.7 * broad + 1.1 * fine), 0.2, 2.0);
    return vec4(mix(ground, snow, snows), 1.0);
}
