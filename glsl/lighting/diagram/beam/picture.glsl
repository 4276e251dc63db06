// lighting/diagram/beam/picture.glsl -- a section of the terrain with a beam to the sun.
//
//   gives    diagram: a colour
//   needs    lighting/diagram/ink.glsl, lighting/diagram/label.glsl, lighting/diagram/paints.glsl,
//            lighting/diagram/section.glsl, maths/angle.glsl, maths/land.glsl; the tests of
//            lighting/diagram/beam/tests.glsl
//   units    colours linear
//   source   Belaiche 2010, figures 3.10, 4.3, 4.5 and 4.6
//   tested   tests/glsl/test_diagrams.py, by the colours where tests say that they must be
//
// The beam is a ray, a cylinder or a cone; its tests are drawn with it.
//
// A test is an upright line as long as the beam is wide, and a dot at its middle: blue where all
// is free, amber where part is hidden, red where all is. Of the upright line the red part is in
// the ground.
#include "lighting/diagram/ink.glsl"
#include "lighting/diagram/label.glsl"
#include "lighting/diagram/paints.glsl"
#include "lighting/diagram/section.glsl"
#include "maths/angle.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "diagram:rgba16f")

uniform sampler2D height;       //! input
uniform sampler2D tests;        //! input
#include "lighting/diagram/parameters/beam.glsl"
#include "lighting/diagram/parameters/section.glsl"
uniform int second = -1;        //! slider(-1, 4096) group("Section")
                                //! Column of a second point; -1: none
uniform float foot = 0.25;      //! slider(0, 0.9) step(0.01) group("Section")
                                //! Where the lowest height is, as a share of the picture's
uniform bool text = true;       //! Write the numbers

const int RAY = 0;
const int CYLINDER = 1;
const int CONE = 2;

// Four characters a number, 32 a text. A byte from 128 on is a place of a number: 128 + 16 · its
// number + its place.
const int TEXTS = 11;
const int LENGTHS[TEXTS] = int[TEXTS](8, 8, 12, 29, 32, 9, 16, 4, 13, 6, 14);
const uvec4 WORDS[2 * TEXTS] = uvec4[2 * TEXTS](
    uvec4(0x203D2056u, 0xB3B2B1B0u, 0u, 0u), uvec4(0u, 0u, 0u, 0u),  // V = ####
    uvec4(0x203D2056u, 0xC3C2C1C0u, 0u, 0u), uvec4(0u, 0u, 0u, 0u),  // V = ####
    uvec4(0x20796172u, 0x80207461u, 0x60838281u, 0u), uvec4(0u, 0u, 0u, 0u),  // ray at ####`
    // cylinder at ####`, r =##### m
    uvec4(0x696C7963u, 0x7265646Eu, 0x20746120u, 0x83828180u),
    uvec4(0x72202C60u, 0x91903D20u, 0x20949392u, 0x0000006Du),
    // cone at ####`, r = ##### a metre
    uvec4(0x656E6F63u, 0x20746120u, 0x83828180u, 0x72202C60u),
    uvec4(0xA0203D20u, 0xA4A3A2A1u, 0x6D206120u, 0x65727465u),
    uvec4(0x74736574u, 0xD1D03A73u, 0x000000D2u, 0u), uvec4(0u, 0u, 0u, 0u),  // tests:###
    // tests:### and###
    uvec4(0x74736574u, 0xD1D03A73u, 0x6E6120D2u, 0xE2E1E064u),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0x65657266u, 0u, 0u, 0u), uvec4(0u, 0u, 0u, 0u),  // free
    // partly hidden
    uvec4(0x74726170u, 0x6820796Cu, 0x65646469u, 0x0000006Eu),
    uvec4(0u, 0u, 0u, 0u),
    uvec4(0x64646968u, 0x00006E65u, 0u, 0u), uvec4(0u, 0u, 0u, 0u),  // hidden
    // highest height
    uvec4(0x68676968u, 0x20747365u, 0x67696568u, 0x00007468u),
    uvec4(0u, 0u, 0u, 0u)
);
// Of the values: characters, and decimals.
const int WIDE[7] = int[7](4, 5, 5, 4, 4, 3, 3);
const int DECIMALS[7] = int[7](1, 1, 3, 2, 2, 0, 0);

vec3 paint_of(float part) {
    return part <= 0.0 ? HIDDEN : part < 1.0 ? PARTLY : FREE;
}

vec4 kernel(ivec2 texel) {
    vec2 paper = vec2(size);
    float u = min(paper.x / 640.0, paper.y / 360.0);
    vec2 place = vec2(texel) + 0.5;
    ivec2 grid = textureSize(height, 0);
    vec2 bounds = texelFetch(tests, ivec2(0, 2), 0).xy;
    ivec2 shown = columns_shown(first, last, grid.x);
    float spacing = spacing_of(grid, extent).x;
    Section section = section_of(clamp(row, 0, grid.y - 1), grid.x, shown, spacing, relief,
                                 bounds.x, foot, paper);
    vec2 to_sun = cos_sin_degrees(elevation);
    float climb = to_sun.y / max(to_sun.x, 1e-6);
    float growth = beam == CONE ? delta_r / max(to_sun.x, 1e-6) : 0.0;
    float wide = beam == CYLINDER ? radius / 255.0 * relief * section.scale : 0.0;
    int viewpoints = second >= 0 ? 2 : 1;

    // The sun is at the end of the first beam, whole in the picture; parallel rays end in
    // arrows.
    vec4 facts = texelFetch(tests, ivec2(0, 0), 0);
    vec2 room = (paper - 12.0 * u - on_paper(section, facts.zw)) / (to_sun + 1e-4);
    float far = max(min(room.x, room.y), 20.0 * u);
    // The disc is as wide as the beam: disc = widens far + level, and far + disc is the room.
    float widens = growth * to_sun.x * to_sun.x;
    float level = beam == RAY ? 15.0 * u : wide * to_sun.x;
    far = max((far - level) / (1.0 + widens), 10.0 * u);
    float disc = widens * far + level;
    bool with_sun = beam != RAY || second < 0;

    vec3 colour = SKY * (0.9 + 0.1 * place.y / paper.y);
    float ground = ground_above(height, section, place);
    float in_ground = covered(ground);
    // The beam in the air, then the ground, then what of the beam is in it.
    float inside = 0.0;
    float edge = 0.0;
    for (int v = 0; v < viewpoints; v++) {
        vec4 about = texelFetch(tests, ivec2(0, v), 0);
        vec2 off = place - on_paper(section, about.zw);
        float ahead = covered(off.x) * (v == 0 ? covered(far - dot(off, to_sun)) : 1.0);
        float half_width = wide + off.x * growth;
        float margin = (half_width - abs(off.y - off.x * climb)) * to_sun.x;
        bool drawn = beam != RAY;
        inside = max(inside, drawn ? covered(margin) * ahead : 0.0);
        edge = max(edge, drawn ? covered(0.7 * u - abs(margin)) * ahead : 0.0);
    }
    colour = mix(colour, SUN, 0.45 * inside);
    colour = mix(colour, PARTLY, edge * 0.8);

    if (with_sun) {
        vec2 sun = on_paper(section, facts.zw) + far * to_sun;
        colour = mix(colour, SUN, dot_cover(place, sun, disc));
        colour = mix(colour, EDGE, covered(0.6 * u - abs(length(place - sun) - disc)));
    }
    colour = mix(colour, GROUND * (0.75 + 0.25 * place.y / paper.y), in_ground);
    colour = mix(colour, HIDDEN, 0.25 * inside * in_ground);
    vec2 surface = surface_cover(height, section, place, 1.8 * u,
                                 min(2.2 * u, 0.3 * section.scale * section.spacing));
    colour = mix(colour, EDGE, max(surface.x, surface.y));

    vec2 highest = on_paper(section, vec2(0.0, bounds.y));
    colour = mix(colour, INK, 0.5 * dash_cover(place, vec2(0.0, highest.y),
                                               vec2(paper.x, highest.y), 1.0 * u, 5.0 * u));

    float pitch = spacing * section.scale;
    for (int v = 0; v < viewpoints; v++) {
        vec4 about = texelFetch(tests, ivec2(0, v), 0);
        vec2 from = on_paper(section, about.zw);
        int made = int(about.y);
        float stopped = float(max(made - 1, 0)) * pitch;
        vec2 end = from + vec2(stopped, stopped * climb);
        vec2 border = (paper - 8.0 * u - from) / max(to_sun, 1e-4);
        vec2 goal = from + (with_sun && v == 0 ? far : min(border.x, border.y)) * to_sun;
        if (about.x > 0.0) {
            float axis = beam == RAY ? line_cover(place, from, goal, 1.6 * u)
                    : dash_cover(place, from, goal, 1.0 * u, 5.0 * u);
            colour = mix(colour, PARTLY * 0.8, axis);
            if (beam == RAY && second >= 0) {
                colour = mix(colour, PARTLY * 0.8,
                             arrow_cover(place, from, goal, 1.6 * u, 11.0 * u));
            }
        } else {
            colour = mix(colour, HIDDEN, line_cover(place, from, end, 1.6 * u));
            colour = mix(colour, HIDDEN, 0.6 * dash_cover(place, end, goal, 1.0 * u, 5.0 * u));
        }
        int near = int(floor((place.x - from.x) / pitch + 0.5));
        int least = int(texelFetch(tests, ivec2(1, v), 0).x);
        for (int k = near - 1; k <= near + 1; k++) {
            // No test is drawn beyond the sun, which is much farther away than the picture is
            // wide.
            if (k < 0 || k >= made || (with_sun && v == 0 && float(k) * pitch > far * to_sun.x)) {
                continue;
            }
            vec4 one = texelFetch(tests, ivec2(2 + k, v), 0);
            float column = from.x + float(k) * pitch;
            float middle = on_paper(section, vec2(0.0, one.x)).y;
            float reach = one.y * section.scale;
            float top = max(middle + reach, middle - reach);
            float bottom = middle - reach;
            float land = clamp(top - one.z * 2.0 * reach, bottom, top);
            bool marked = k == least;
            float pen = marked ? 3.2 * u : 1.6 * u;
            if (reach > 0.0) {
                colour = mix(colour, HIDDEN,
                             line_cover(place, vec2(column, bottom), vec2(column, land), pen)
                             * step(one.z, 0.999));
                colour = mix(colour, paint_of(one.z),
                             line_cover(place, vec2(column, land), vec2(column, top), pen)
                             * step(0.001, one.z));
            }
            float spot = min(marked ? 4.2 * u : 3.0 * u, 0.45 * pitch);
            colour = mix(colour, paint_of(one.z), dot_cover(place, vec2(column, middle), spot));
        }
        colour = mix(colour, SKY, dot_cover(place, from, 6.6 * u));
        colour = mix(colour, paint_of(about.x), dot_cover(place, from, 5.2 * u));
    }
    if (!text) return vec4(colour, 1.0);

    vec4 other = texelFetch(tests, ivec2(0, 1), 0);
    float values[7] = float[7](elevation, radius / 255.0 * relief, delta_r, facts.x, other.x,
                               facts.y, other.y);
    int board = -1;
    vec3 cell = vec3(-1.0);
    float behind = 0.0;
    float legend = 0.0;
    vec3 legend_paint = INK;
    for (int k = 0; k < 8; k++) {
        int which = k < 2 ? k : k == 2 ? 2 + beam : k == 3 ? (second >= 0 ? 6 : 5) : k + 3;
        int characters = LENGTHS[which];
        if (k == 1 && second < 0) characters = 0;
        if (k == 7 && (highest.y < 0.0 || highest.y > paper.y - 60.0 * u)) characters = 0;
        Label label = label_on_left(vec2(12.0 * u, paper.y - (31.0 + 17.0 * float(k - 2)) * u),
                                    characters, u);
        if (k < 2) {
            label = label_around(on_paper(section, k == 0 ? facts.zw : other.zw)
                                 - vec2(0.0, 27.0 * u), characters, u);
        }
        if (k == 7) label = label_on_left(vec2(12.0 * u, highest.y + 4.0 * u), characters, u);
        if (k >= 4 && k < 7) {
            // A legend along the lower edge, each entry after its dot.
            float at = k == 4 ? 26.0 : k == 5 ? 92.0 : 230.0;
            label = label_on_left(vec2(at * u, 10.0 * u), characters, u);
            float spot = dot_cover(place, label.corner + vec2(-8.0, 7.5) * u, 4.2 * u);
            legend = max(legend, spot);
            if (spot > 0.0) legend_paint = k == 4 ? FREE : k == 5 ? PARTLY : HIDDEN;
            behind = max(behind, dot_cover(place, label.corner + vec2(-8.0, 7.5) * u, 7.5 * u));
        }
        behind = max(behind, board_cover(label, place));
        vec3 found = cell_of(label, place);
        if (found.x >= 0.0 && characters > 0) {
            board = which;
            cell = found;
        }
    }
    colour = mix(colour, SKY, 0.75 * behind);
    colour = mix(colour, legend_paint, legend);
    if (board >= 0) {
        int at = int(cell.x);
        int character = character_of(WORDS[2 * board + (at >> 4)], at & 15);
        if (character >= 128) {
            int number = (character >> 4) & 7;
            character = number_character(values[number], DECIMALS[number], character & 15,
                                         WIDE[number]);
        }
        colour = mix(colour, INK, covered((0.75 - letter_distance(character, cell.yz)) * u));
    }
    return vec4(colour, 1.0);
}
