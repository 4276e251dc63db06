// lighting/diagram/horizon/picture.glsl -- a section with the horizons of a point.
//
//   gives    diagram: a colour
//   needs    lighting/diagram/ink.glsl, lighting/diagram/label.glsl, lighting/diagram/paints.glsl,
//            lighting/diagram/section.glsl, maths/land.glsl; the angles of
//            lighting/diagram/horizon/angles.glsl
//   units    colours linear
//   source   Belaiche 2010, section 3.4, figures 3.1, 3.2 and 3.3
//   tested   tests/glsl/test_diagrams.py, by the colours where angles say that they must be
//
// The thesis measures horizons as shares of a quarter circle; degrees are written next to them.
// The sun's disc is drawn as wide as its parameter says, which may be wider than the real one.
#include "lighting/diagram/ink.glsl"
#include "lighting/diagram/label.glsl"
#include "lighting/diagram/paints.glsl"
#include "lighting/diagram/section.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "diagram:rgba16f", relief = "true")

uniform sampler2D height;       //! input
uniform sampler2D angles;       //! input
uniform int shows = 0;          //! menu("horizon angle", "effective horizon",
                                //! "visibility of the sun")
                                //! Which of the three
#include "lighting/diagram/parameters/section.glsl"
uniform float foot = 0.25;      //! slider(0, 0.9) step(0.01) group("Section")
                                //! Where the lowest height is, as a share of the picture's
#include "lighting/diagram/parameters/disc.glsl"
uniform bool text = true;       //! Write the numbers

const int HORIZON_ANGLE = 0;
const int EFFECTIVE = 1;
const int SUN_SEEN = 2;
const float HALF_PI = 1.5707963;
const float ARC = 62.0;      // radii and lengths for a picture 360 pixels high
const float HEMISPHERE = 92.0;
const float NORMAL = 78.0;

// Four characters a number, 32 a text. A byte from 128 on is a place of a number: 128 + 16 · its
// number + its place.
const int TEXTS = 9;
const int LENGTHS[TEXTS] = int[TEXTS](6, 6, 26, 26, 31, 31, 24, 17, 27);
const uvec4 WORDS[2 * TEXTS] = uvec4[2 * TEXTS](
    uvec4(0x83828180u, 0x00006084u, 0u, 0u), uvec4(0u, 0u, 0u, 0u),  // #####`
    uvec4(0x93929190u, 0x00006094u, 0u, 0u), uvec4(0u, 0u, 0u, 0u),  // #####`
    // east #####` = ##### of 90`
    uvec4(0x74736165u, 0x82818020u, 0x20608483u, 0xA1A0203Du),
    uvec4(0x20A4A3A2u, 0x3920666Fu, 0x00006030u, 0u),
    // west #####` = ##### of 90`
    uvec4(0x74736577u, 0x92919020u, 0x20609493u, 0xB1B0203Du),
    uvec4(0x20B4B3B2u, 0x3920666Fu, 0x00006030u, 0u),
    // east: terrain #####`, plane #####`
    uvec4(0x74736165u, 0x616C203Au, 0xA020646Eu, 0xA4A3A2A1u),
    uvec4(0x70202C60u, 0x656E616Cu, 0xC2C1C020u, 0x0060C4C3u),
    // west: terrain #####`, plane #####`
    uvec4(0x74736577u, 0x616C203Au, 0xB020646Eu, 0xB4B3B2B1u),
    uvec4(0x70202C60u, 0x656E616Cu, 0xD2D1D020u, 0x0060D4D3u),
    // sun at ####`, ####` wide
    uvec4(0x206E7573u, 0xC0207461u, 0x60C3C2C1u, 0xD1D0202Cu),
    uvec4(0x2060D3D2u, 0x65646977u, 0u, 0u),
    // horizon at #####`
    uvec4(0x69726F68u, 0x206E6F7Au, 0x80207461u, 0x84838281u),
    uvec4(0x00000060u, 0u, 0u, 0u),
    // V = ####, area of disc ####
    uvec4(0x203D2056u, 0xE3E2E1E0u, 0x7261202Cu, 0x6F206165u),
    uvec4(0x69642066u, 0xF0206373u, 0x00F3F2F1u, 0u)
);

// The pixel that looks along an angle from the viewpoint, to the right or the left.
vec2 direction_of(float angle, float side) {
    return vec2(side * cos(angle), sin(angle));
}

vec4 kernel(ivec2 texel) {
    vec2 paper = vec2(size);
    float u = min(paper.x / 640.0, paper.y / 360.0);
    vec2 place = vec2(texel) + 0.5;
    ivec2 grid = textureSize(height, 0);
    vec4 east = texelFetch(angles, ivec2(0, 0), 0);
    vec4 west = texelFetch(angles, ivec2(1, 0), 0);
    vec4 seen = texelFetch(angles, ivec2(2, 0), 0);
    float lowest = texelFetch(angles, ivec2(3, 0), 0).x;
    ivec2 shown = columns_shown(first, last, grid.x);
    Section section = section_of(clamp(row, 0, grid.y - 1), grid.x, shown,
                                 spacing_of(grid, extent).x, relief, lowest, foot, paper);
    vec2 eye = on_paper(section, seen.xy);
    float farthest = paper.x + paper.y;
    vec2 off = place - eye;
    float upper = radians(elevation + 0.5 * diameter);
    float lower = radians(elevation - 0.5 * diameter);

    vec3 colour = SKY * (0.9 + 0.1 * place.y / paper.y);
    // The sun, as far away as the picture's edge lets it be.
    vec2 to_middle = direction_of(radians(elevation), 1.0);
    float spread = sin(0.5 * radians(diameter));
    vec2 room = (paper - 20.0 * u - eye) / (to_middle + spread + 1e-4);
    float far = max(min(room.x, room.y), 10.0 * u);
    vec2 sun = eye + far * to_middle;
    float disc = far * spread;
    vec2 over = direction_of(east.w, 1.0);
    if (shows == SUN_SEEN) {
        colour = mix(colour, SUN, 0.25 * sector_cover(place, eye, far, lower, upper));
        float lit = half_plane(place, eye, over);
        colour = mix(colour, mix(DULL, SUN, lit), dot_cover(place, sun, disc));
        colour = mix(colour, EDGE, covered(0.6 * u - abs(length(place - sun) - disc)));
    }
    colour = mix(colour, GROUND * (0.75 + 0.25 * place.y / paper.y),
                 covered(ground_above(height, section, place)));

    // The hemisphere of the normal, whose flat side is the plane.
    vec2 along = normalize(vec2(1.0, east.z));
    vec2 normal = vec2(-along.y, along.x);
    if (shows == EFFECTIVE) {
        float half_disc = covered(HEMISPHERE * u - length(off)) * half_plane(place, eye, along);
        colour = mix(colour, SUN, 0.2 * half_disc);
        float arc = covered(0.6 * u - abs(length(off) - HEMISPHERE * u))
                * half_plane(place, eye, along);
        colour = mix(colour, PARTLY, arc);
    }
    for (int k = 0; k < 2; k++) {
        float side = k == 0 ? 1.0 : -1.0;
        vec4 facts = k == 0 ? east : west;
        if (shows == SUN_SEEN && k == 1) continue;
        vec2 mirrored = eye + vec2(side * off.x, off.y);
        float land = atan(facts.x);
        float shown_angle = shows == HORIZON_ANGLE ? land : facts.w;
        bool known = shows != HORIZON_ANGLE || facts.y >= 0.0;
        if (known) {
            float from = min(shown_angle, 0.0);
            float to = max(shown_angle, 0.0);
            colour = mix(colour, FREE, 0.28 * sector_cover(mirrored, eye, ARC * u, from, to));
            colour = mix(colour, FREE, arc_cover(mirrored, eye, ARC * u, from, to, 1.6 * u));
        }
        // What the plane takes away above the terrain's own horizon.
        if (shows == EFFECTIVE && facts.z > facts.x) {
            colour = mix(colour, HIDDEN, 0.45
                         * sector_cover(mirrored, eye, HEMISPHERE * u, max(land, -HALF_PI),
                                        facts.w));
        }
    }

    vec2 surface = surface_cover(height, section, place, 1.8 * u,
                                 min(2.2 * u, 0.3 * section.scale * section.spacing));
    colour = mix(colour, EDGE, max(surface.x, surface.y));

    colour = mix(colour, INK, 0.7 * dash_cover(place, eye - vec2(farthest, 0.0),
                                               eye + vec2(farthest, 0.0), 1.0 * u, 5.0 * u));
    for (int k = 0; k < 2; k++) {
        float side = k == 0 ? 1.0 : -1.0;
        vec4 facts = k == 0 ? east : west;
        if (shows == SUN_SEEN && k == 1) continue;
        if (facts.y >= 0.0) {
            vec2 touch = node_on_paper(height, section, int(facts.y));
            vec2 direction = direction_of(atan(facts.x), side);
            colour = mix(colour, FREE, line_cover(place, eye, touch, 1.6 * u));
            float dashes = dash_cover(place, touch, eye + farthest * direction, 1.4 * u, 7.0 * u);
            colour = mix(colour, FREE, dashes);
            colour = mix(colour, FREE, dot_cover(place, touch, 4.0 * u));
        }
        if (shows != HORIZON_ANGLE && facts.z > facts.x) {
            vec2 direction = direction_of(facts.w, side);
            float dashes = dash_cover(place, eye, eye + farthest * direction, 1.6 * u, 9.0 * u);
            colour = mix(colour, HIDDEN, dashes);
        }
    }
    if (shows == EFFECTIVE) {
        vec2 half_line = HEMISPHERE * u * along;
        float level = line_cover(place, eye - half_line, eye + half_line, 1.6 * u);
        colour = mix(colour, PARTLY * 0.7, level);
        colour = mix(colour, INK, arrow_cover(place, eye, eye + NORMAL * u * normal, 2.0 * u,
                                              11.0 * u));
    }
    if (shows == SUN_SEEN) {
        float length_of_edge = far * cos(0.5 * radians(diameter));
        vec2 to_upper = eye + length_of_edge * direction_of(upper, 1.0);
        vec2 to_lower = eye + length_of_edge * direction_of(lower, 1.0);
        colour = mix(colour, PARTLY * 0.8, line_cover(place, eye, to_upper, 1.2 * u));
        colour = mix(colour, PARTLY * 0.8, line_cover(place, eye, to_lower, 1.2 * u));
    }
    colour = mix(colour, SKY, dot_cover(place, eye, 6.0 * u));
    colour = mix(colour, INK, dot_cover(place, eye, 4.6 * u));
    if (!text) return vec4(colour, 1.0);

    float values[8] = float[8](
        degrees(shows == HORIZON_ANGLE ? atan(east.x) : east.w),
        degrees(shows == HORIZON_ANGLE ? atan(west.x) : west.w),
        shows == HORIZON_ANGLE ? max(atan(east.x), 0.0) / HALF_PI : degrees(atan(east.x)),
        shows == HORIZON_ANGLE ? max(atan(west.x), 0.0) / HALF_PI : degrees(atan(west.x)),
        shows == SUN_SEEN ? elevation : degrees(atan(east.z)),
        shows == SUN_SEEN ? diameter : degrees(atan(west.z)),
        seen.z,
        seen.w
    );
    int board = -1;
    vec3 cell = vec3(-1.0);
    float behind = 0.0;
    for (int k = 0; k < 5; k++) {
        // Two labels at the lines, three lines of text.
        int which = k < 2 ? k : shows == HORIZON_ANGLE ? k : shows == EFFECTIVE ? k + 2 : k + 4;
        int characters = LENGTHS[which];
        if (shows == SUN_SEEN && k < 2) characters = 0;
        if (shows == HORIZON_ANGLE && k < 4 && (k & 1) == 0 && east.y < 0.0) characters = 0;
        if (shows == HORIZON_ANGLE && k < 4 && (k & 1) == 1 && west.y < 0.0) characters = 0;
        if (shows != SUN_SEEN && k == 4) characters = 0;
        Label label = label_on_left(vec2(12.0 * u, paper.y - (14.0 + 17.0 * float(k - 1)) * u),
                                    characters, u);
        if (k == 0) {
            vec2 direction = direction_of(radians(values[0]), 1.0);
            label = label_on_right(eye + 175.0 * u * direction + vec2(-4.0, 6.0) * u,
                                   characters, u);
        } else if (k == 1) {
            vec2 direction = direction_of(radians(values[1]), -1.0);
            label = label_on_left(eye + 175.0 * u * direction + vec2(4.0, 6.0) * u, characters, u);
        }
        behind = max(behind, board_cover(label, place));
        vec3 found = cell_of(label, place);
        if (found.x >= 0.0 && characters > 0) {
            board = which;
            cell = found;
        }
    }
    colour = mix(colour, SKY, 0.75 * behind);
    if (board >= 0) {
        int at = int(cell.x);
        int character = character_of(WORDS[2 * board + (at >> 4)], at & 15);
        if (character >= 128) {
            int number = (character >> 4) & 7;
            bool share = number >= 6 || (shows == HORIZON_ANGLE && number >= 2);
            int wide = share ? (number >= 6 ? 4 : 5) : (shows == SUN_SEEN && number >= 4) ? 4 : 5;
            character = number_character(values[number], share ? wide - 2 : 1, character & 15,
                                         wide);
        }
        float pen = covered((0.75 - letter_distance(character, cell.yz)) * u);
        colour = mix(colour, INK, pen);
    }
    return vec4(colour, 1.0);
}
