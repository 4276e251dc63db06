// generation/endless/principle.glsl -- a picture of how an endless terrain is made.
//
//   gives    picture, linear light
//   needs    lighting/diagram/ink.glsl, lighting/diagram/label.glsl; the shape, the detail,
//            and height, colour and light of the 3 x 3 parts in their middle
//   units    pixels
//   source   Belaiche 2010, section 5.6, figure 5.15; drawn here from data
//   tested   tests/glsl/test_endless.py, by the places of things
//
// Above on the left, the shape of the terrain, cut into parts; below it the one detail component.
// On the right the detail put on a part and its neighbours, and only that part in light and
// colour.
#include "lighting/diagram/ink.glsl"
#include "lighting/diagram/label.glsl"
#pragma kernel(output = "picture:rgba16f")

uniform sampler2D shape;    //! input
uniform sampler2D detail;   //! input
uniform sampler2D height;   //! input
uniform sampler2D colour;   //! input
uniform sampler2D light;    //! input

uniform vec3 paper = vec3(0.87, 0.86, 0.82);  //! colour Behind everything
uniform vec3 ink = vec3(0.03, 0.03, 0.035);   //! colour Letters and arrows
uniform vec3 chosen = vec3(0.80, 0.28, 0.02); //! colour The part reached, and its neighbours

const uvec4 TEXTS[6] = uvec4[6](  // shape, in parts / one detail / detail on nine, light on one
    uvec4(0x70616873u, 0x69202C65u, 0x6170206Eu, 0x00737472u), uvec4(0u, 0u, 0u, 0u),
    uvec4(0x20656E6Fu, 0x61746564u, 0x00006C69u, 0u), uvec4(0u, 0u, 0u, 0u),
    uvec4(0x61746564u, 0x6F206C69u, 0x696E206Eu, 0x202C656Eu),
    uvec4(0x6867696Cu, 0x6E6F2074u, 0x656E6F20u, 0u)
);
const int LENGTHS[3] = int[3](15, 10, 28);

// Grey as light from the north-west would have it, on a field whose heights are `steep` texels
// high.
vec3 shaded(sampler2D field, vec2 share, float steep) {
    ivec2 last = textureSize(field, 0) - 1;
    ivec2 node = clamp(ivec2(share * vec2(last) + 0.5), ivec2(1), last - 1);
    vec2 rise = 0.5 * steep * vec2(
        texelFetch(field, node + ivec2(1, 0), 0).r - texelFetch(field, node - ivec2(1, 0), 0).r,
        texelFetch(field, node + ivec2(0, 1), 0).r - texelFetch(field, node - ivec2(0, 1), 0).r);
    vec3 normal = normalize(vec3(-rise, 1.0));
    float lit = max(dot(normal, normalize(vec3(-0.5, 0.5, 0.8))), 0.0);
    // A little by height as well, so that valleys and mountains are distinguished.
    return vec3(0.78, 0.79, 0.80) * lit * (0.55 + 0.6 * texelFetch(field, node, 0).r);
}

vec3 at_share(sampler2D field, vec2 share) {
    return texelFetch(field, ivec2(share * vec2(textureSize(field, 0) - 1) + 0.5), 0).rgb;
}

// A square's edge, so many pixels wide, drawn around `corner .. corner + side`.
float frame_cover(vec2 place, vec2 corner, float side, float width) {
    vec2 offset = abs(place - corner - 0.5 * side) - 0.5 * side;
    return covered(0.5 * width - abs(max(offset.x, offset.y)));
}

// Lines between so many parts a side.
float parts_cover(vec2 place, vec2 corner, float side, float parts, float width) {
    vec2 along = (place - corner) / side * parts;
    vec2 off = abs(fract(along + 0.5) - 0.5) * side / parts;
    return covered(0.5 * width - min(off.x, off.y));
}

vec4 kernel(ivec2 texel) {
    float unit = float(size.y) / 360.0;
    vec2 place = (vec2(texel) + 0.5) / unit;
    vec2 first = vec2(24.0, 202.0);
    vec2 second = vec2(36.0, 32.0);
    vec2 third = vec2(306.0, 38.0);
    float small = 140.0, tile = 116.0, large = 300.0;
    vec3 seen = paper;

    vec2 share = (place - first) / small;
    if (all(equal(share, clamp(share, 0.0, 1.0)))) {
        seen = shaded(shape, share, 160.0);
        seen = mix(seen, ink, 0.65 * parts_cover(place, first, small, 5.0, 1.0));
    }
    share = (place - second) / tile;
    if (all(equal(share, clamp(share, 0.0, 1.0)))) seen = shaded(detail, share, 22.0);
    share = (place - third) / large;
    if (all(equal(share, clamp(share, 0.0, 1.0)))) {
        seen = shaded(height, share, 130.0);
        vec2 part = floor(share * 3.0);
        if (part == vec2(1.0)) seen = at_share(colour, share) * at_share(light, share);
        seen = mix(seen, ink, 0.5 * parts_cover(place, third, large, 3.0, 1.2));
    }
    seen = mix(seen, ink, frame_cover(place, first, small, 1.4));
    seen = mix(seen, ink, frame_cover(place, second, tile, 1.4));
    seen = mix(seen, chosen, frame_cover(place, first + 0.2 * small, 0.6 * small, 2.0));
    seen = mix(seen, chosen, frame_cover(place, first + 0.4 * small, 0.2 * small, 2.4));
    seen = mix(seen, chosen, frame_cover(place, third, large, 2.4));
    seen = mix(seen, chosen, frame_cover(place, third + large / 3.0, large / 3.0, 3.0));
    seen = mix(seen, ink, arrow_cover(place, vec2(182.0, 262.0), vec2(292.0, 232.0), 2.2, 9.0));
    seen = mix(seen, ink, arrow_cover(place, vec2(182.0, 98.0), vec2(292.0, 138.0), 2.2, 9.0));

    for (int k = 0; k < 3; k++) {
        vec2 foot = third + vec2(0.5 * large, -22.0);
        if (k == 0) foot = first + vec2(0.5 * small, -19.0);
        if (k == 1) foot = second + vec2(0.5 * tile, -20.0);
        Label label = label_around(foot, LENGTHS[k], 1.15);
        vec3 cell = cell_of(label, place);
        if (cell.x >= 0.0) {
            int place_in_text = int(cell.x);
            uvec4 text = TEXTS[2 * k + (place_in_text >> 4)];
            float gap = letter_distance(character_of(text, place_in_text & 15), cell.yz);
            seen = mix(seen, ink, covered((0.75 - gap) * 1.15 * unit));
        }
    }
    return vec4(seen, 1.0);
}
