// view/lattice.glsl -- the points of a small terrain as discs.
//
//   gives    frame, display-encoded
//   needs    colour/encode.glsl
//   units    heights and phases as they are; lowest and highest as the heights; radii in
//            spacings of the lattice, lines in pixels
//   source   Belaiche 2010, figures 1.8 to 1.11, which show red, blue, green and orange points
//   tested   tests/glsl/test_halving.py, against the colours at the points
//
// They are grey by height, with a ring in the colour of their phase.
//
// A point of phase 0 is not known yet and is an empty circle. Phases from 1 have the five
// colours in turn; beyond the fifth, the fourth and the fifth go on.
#include "colour/encode.glsl"
#pragma kernel(output = "frame:rgba8")

uniform sampler2D height;      //! input
uniform sampler2D phase;       //! input
uniform float lowest = 0.0;    //! slider(-2, 2) step(0.01) group("Range") The height shown darkest
uniform float highest = 1.0;   //! slider(-2, 2) step(0.01) group("Range")
                               //! The height shown brightest
uniform float radius = 0.3;    //! slider(0.05, 0.5) step(0.01)
                               //! Of a disc with its ring, in spacings of the lattice
uniform vec3 first = vec3(0.0, 0.0, 0.0);       //! colour group("Phases")
                                                //! Ring of the points that were given
uniform vec3 second = vec3(0.78, 0.01, 0.01);   //! colour group("Phases") Ring of the second phase
uniform vec3 third = vec3(0.01, 0.09, 0.78);    //! colour group("Phases") Ring of the third
uniform vec3 fourth = vec3(0.0, 0.32, 0.02);    //! colour group("Phases") Ring of the fourth
uniform vec3 fifth = vec3(1.0, 0.22, 0.0);      //! colour group("Phases") Ring of the fifth
uniform vec3 paper = vec3(1.0, 1.0, 1.0);       //! colour Behind the points
uniform vec3 line = vec3(0.6, 0.6, 0.6);        //! colour
                                                //! The lattice's lines, and points that are not
                                                //! known yet

const float RING = 0.34;   // of the radius
const float HOLLOW = 0.4;  // radius of an unknown point's circle, of a known one's

vec3 colour_of(int number) {
    int shown = number <= 5 ? number : 4 + (number & 1);
    return shown <= 1 ? first : shown == 2 ? second : shown == 3 ? third : shown == 4 ? fourth
            : fifth;
}

vec4 kernel(ivec2 texel) {
    ivec2 count = textureSize(height, 0);
    // One spacing is free around the points, and the whole is in the middle.
    vec2 sides = vec2(size) / vec2(count);
    float cell = min(sides.x, sides.y);
    vec2 place = (vec2(texel) + 0.5 - 0.5 * vec2(size)) / cell + 0.5 * vec2(count - 1);
    ivec2 point = ivec2(clamp(floor(place + 0.5), vec2(0.0), vec2(count - 1)));
    vec2 offset = place - vec2(point);
    float far = length(offset) * cell;

    vec2 outside = max(max(-place, place - vec2(count - 1)), 0.0) * cell;
    vec2 cover = clamp(1.0 - abs(offset) * cell, 0.0, 1.0) * clamp(1.0 - outside.yx, 0.0, 1.0);
    vec3 colour = mix(srgb_from_linear(paper), srgb_from_linear(line), max(cover.x, cover.y));

    int number = int(texelFetch(phase, point, 0).r + 0.5);
    float h = texelFetch(height, point, 0).r;
    float span = highest - lowest;
    vec3 inside = vec3(clamp((h - lowest) / (abs(span) < 1e-20 ? 1e-20 : span), 0.0, 1.0));
    float outer = radius * cell;
    float inner = outer * (1.0 - RING);
    vec3 ring = srgb_from_linear(colour_of(number));
    if (number <= 0) {
        outer *= HOLLOW;
        inner = outer - 1.5;
        ring = srgb_from_linear(line);
        inside = srgb_from_linear(paper);
    }
    colour = mix(colour, ring, clamp(outer - far + 0.5, 0.0, 1.0));
    colour = mix(colour, inside, clamp(inner - far + 0.5, 0.0, 1.0));
    return vec4(colour, 1.0);
}
