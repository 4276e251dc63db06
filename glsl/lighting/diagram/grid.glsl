// lighting/diagram/grid.glsl -- the texels around one, from above.
//
//   gives    diagram: a colour
//   needs    lighting/diagram/ink.glsl, lighting/diagram/label.glsl, lighting/diagram/paints.glsl,
//            lighting/sun.glsl, terrain/heightfield.glsl
//   units    heights are written in grey levels, 255 from height 0 to 1; colours linear
//   source   Belaiche 2010, section 3.5.1, figure 3.5
//   tested   tests/glsl/test_diagrams.py, by colours at their places and against the method itself
//
// It shows which place towards the sun the height difference reads.
//
// The picture is a map, north on top, of the texel in its middle. Texels higher than that one are
// brown, lower ones blue; the deepest brown takes all light. The method reads the ring, between
// the four texels around it; the dots after it are where a ray would go on.
#include "lighting/diagram/ink.glsl"
#include "lighting/diagram/label.glsl"
#include "lighting/diagram/paints.glsl"
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "diagram:rgba16f")

uniform sampler2D height;                //! input
uniform int column = 32;                 //! slider(0, 4096) group("Place")
                                         //! Of the texel in the middle, from the west
uniform int row = 32;                    //! slider(0, 4096) group("Place")
                                         //! Of the texel in the middle, from the south
uniform float texels = 13.0;             //! slider(3, 40) step(1) group("Place")
                                         //! How many texels fill the picture's width
#include "lighting/parameters/one_step.glsl"
uniform float softness = 0.05;           //! log_slider(0.001, 1)
                                         //! How much higher the place towards the sun may be
                                         //! before all light is gone
uniform int steps = 4;                   //! slider(1, 64) Places shown, the first of which is read
uniform bool text = true;                //! Write the numbers

const vec3 HIGHER = vec3(0.42, 0.22, 0.06);
const vec3 LOWER = vec3(0.20, 0.42, 0.62);

// Four characters a number, 32 a text. A byte from 128 on is a place of a number: 128 + 16 · its
// number + its place.
const int TEXTS = 5;
const int LENGTHS[TEXTS] = int[TEXTS](10, 21, 25, 19, 23);
const uvec4 WORDS[2 * TEXTS] = uvec4[2 * TEXTS](
    uvec4(0x65726568u, 0x83828180u, 0x00008584u, 0u), uvec4(0u, 0u, 0u, 0u),  // here######
    // towards the sun######
    uvec4(0x61776F74u, 0x20736472u, 0x20656874u, 0x906E7573u),
    uvec4(0x94939291u, 0x00000095u, 0u, 0u),
    // rise######, softness#####
    uvec4(0x65736972u, 0xA3A2A1A0u, 0x202CA5A4u, 0x74666F73u),
    uvec4(0x7373656Eu, 0xB3B2B1B0u, 0x000000B4u, 0u),
    // share of light#####
    uvec4(0x72616873u, 0x666F2065u, 0x67696C20u, 0xC1C07468u),
    uvec4(0x00C4C3C2u, 0u, 0u, 0u),
    // towards the sun no terrain
    uvec4(0x61776F74u, 0x20736472u, 0x20656874u, 0x206E7573u),
    uvec4(0x6C206F6Eu, 0x00646E61u, 0u, 0u)
);
const int WIDE[5] = int[5](6, 6, 6, 5, 5);
const int DECIMALS[5] = int[5](1, 1, 1, 1, 2);

vec4 kernel(ivec2 texel) {
    vec2 paper = vec2(size);
    float u = min(paper.x / 640.0, paper.y / 360.0);
    vec2 place = vec2(texel) + 0.5;
    ivec2 grid = textureSize(height, 0);
    ivec2 last = grid - 1;
    ivec2 here = clamp(ivec2(column, row), ivec2(0), last);
    float pitch = paper.x / max(texels, 1.0);
    // Texels of the terrain, whole ones at their middles.
    vec2 spot = (place - 0.5 * paper) / pitch + vec2(here);
    ivec2 cell = ivec2(floor(spot + 0.5));
    bool on_land = all(greaterThanEqual(cell, ivec2(0))) && all(lessThanEqual(cell, last));
    float foot = texelFetch(height, here, 0).r;
    float level = texelFetch(height, clamp(cell, ivec2(0), last), 0).r;
    float soft = max(softness, 1e-6);

    vec2 direction = to_sun(vec2(sun.x, 0.0)).xy / spacing_of(grid, extent);
    direction /= max(abs(direction.x), abs(direction.y));
    vec2 read = vec2(here) + step_length * direction;
    bool off = any(lessThan(read, vec2(-1e-3))) || any(greaterThan(read, vec2(last) + 1e-3));
    float there = height_at(height, read);
    float share = off ? 1.0 : clamp(1.0 - (there - foot) / soft, 0.0, 1.0);

    float rise = (level - foot) / soft;
    vec3 colour = mix(SKY, rise > 0.0 ? HIGHER : LOWER, 0.9 * min(abs(rise), 1.0));
    if (!on_land) colour = SKY * 0.35;
    vec2 from_side = (0.5 - abs(spot - vec2(cell))) * pitch;
    colour = mix(colour, EDGE, 0.55 * covered(0.5 * u - min(from_side.x, from_side.y)));
    // The four texels that the place is read between.
    ivec2 low = ivec2(clamp(floor(read), vec2(0.0), vec2(last)));
    bool around = all(greaterThanEqual(cell, low))
            && all(lessThanEqual(cell, low + ivec2(ceil(read - vec2(low)))));
    if (around && !off) {
        colour = mix(colour, PARTLY, 0.9 * covered(3.0 * u - min(from_side.x, from_side.y)));
    }
    if (cell == here) colour = mix(colour, INK, covered(2.6 * u - min(from_side.x, from_side.y)));

    vec2 middle = 0.5 * paper;
    vec2 along = direction / length(direction);
    vec2 room = (0.5 * paper - 26.0 * u) / max(abs(along), 1e-4);
    vec2 bright = middle + min(room.x, room.y) * along;
    float line = arrow_cover(place, bright, middle, 2.2 * u, 12.0 * u);
    colour = mix(colour, PARTLY * 0.75, line);
    colour = mix(colour, SUN, dot_cover(place, bright, 17.0 * u));
    colour = mix(colour, EDGE, covered(0.6 * u - abs(length(place - bright) - 17.0 * u)));
    vec2 beyond = read;
    for (int k = 2; k <= steps; k++) {
        beyond += max(step_length, 0.25) * direction;
        vec2 at = middle + (beyond - vec2(here)) * pitch;
        bool inside = all(greaterThanEqual(beyond, vec2(-1e-3)))
                && all(lessThanEqual(beyond, vec2(last) + 1e-3));
        bool before = dot(at - middle, along) < min(room.x, room.y) - 20.0 * u;
        if (inside && before) colour = mix(colour, INK, dot_cover(place, at, 3.2 * u));
    }
    float over = max(line, dot_cover(place, bright, 18.0 * u));
    vec2 ring = middle + (read - vec2(here)) * pitch;
    colour = mix(colour, SKY, dot_cover(place, ring, 7.0 * u));
    colour = mix(colour, HIDDEN, dot_cover(place, ring, 5.4 * u));
    over = max(over, dot_cover(place, ring, 7.0 * u));
    if (!text) return vec4(colour, 1.0);

    float values[5] = float[5](255.0 * foot, 255.0 * there, 255.0 * (there - foot),
                               255.0 * softness, share);
    int board = -1;
    vec3 found = vec3(-1.0);
    // One board behind four lines.
    vec2 inside = vec2(118.0, 35.0) * u - abs(place - vec2(124.0 * u, paper.y - 49.0 * u));
    float behind = covered(min(inside.x, inside.y));
    for (int k = 0; k < 4; k++) {
        int which = k == 1 && off ? 4 : k;
        Label label = label_on_left(vec2(12.0 * u, paper.y - (31.0 + 17.0 * float(k)) * u),
                                    k == 2 && off ? 0 : LENGTHS[which], u);
        vec3 at = cell_of(label, place);
        if (at.x >= 0.0 && label.characters > 0) {
            board = which;
            found = at;
        }
    }
    int character = 32;
    if (board >= 0) {
        int at = int(found.x);
        character = character_of(WORDS[2 * board + (at >> 4)], at & 15);
        if (character >= 128) {
            int number = (character >> 4) & 7;
            character = number_character(values[number], DECIMALS[number], character & 15,
                                         WIDE[number]);
        }
        over = 0.0;
    } else if (on_land && pitch > 34.0 * u && behind == 0.0) {
        // The height of each texel, in the lower half of its square.
        vec2 centre = middle + vec2(cell - here) * pitch;
        Label label = label_around(centre - vec2(0.0, 0.42 * pitch), 3, u);
        found = cell_of(label, place);
        // A number that the board would cut is left out.
        bool cut = label.corner.x < 250.0 * u && label.corner.y > paper.y - 101.0 * u;
        if (found.x >= 0.0 && !cut) {
            character = number_character(255.0 * level, 0, int(found.x), 3);
        }
    }
    colour = mix(colour, SKY, 0.92 * behind);
    float pen = covered((0.75 - letter_distance(character, found.yz)) * u) * (1.0 - over);
    return vec4(mix(colour, INK, pen), 1.0);
}
