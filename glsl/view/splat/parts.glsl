// view/splat/parts.glsl -- what a splatted terrain is made of.
//
//   gives    frame, display-encoded
//   needs    colour/encode.glsl; four tiles, weights, the baked colour; a light if there is one
//   units    tiles and colour linear, weights 0..1 shown as greys; the picture's parts in pixels
//   source   Belaiche 2010, figure 2.9
//   tested   tests/glsl/test_splat_view.py, by what is in each part
//
// Four tiles, their alpha maps below, the result next to them.
#include "colour/encode.glsl"
#pragma kernel(output = "frame:rgba8")

uniform sampler2D grass;    //! input("linear", "repeat", "mipmap")
uniform sampler2D rock;     //! input("linear", "repeat", "mipmap")
uniform sampler2D snow;     //! input("linear", "repeat", "mipmap")
uniform sampler2D path;     //! input("linear", "repeat", "mipmap")
uniform sampler2D weights;  //! input("linear", "mipmap")
uniform sampler2D colour;   //! input("linear", "mipmap")
uniform sampler2D light;    //! input("linear", "mipmap", "white")

uniform float gap = 6.0;                  //! slider(0, 50) step(1) unit("pixels")
                                          //! Left free between the parts
uniform vec3 paper = vec3(1.0);           //! colour Behind them

// An image where 0..1 is one side of a part, `side` pixels wide.
vec3 shown_at(sampler2D image, vec2 place, float side) {
    return textureLod(image, place, max(log2(float(textureSize(image, 0).x) / side), 0.0)).rgb;
}

vec4 kernel(ivec2 texel) {
    // Six parts wide and two high, with the result as large as four.
    float side = floor(min((float(size.x) - 6.0 * gap) / 6.0, (float(size.y) - 3.0 * gap) / 2.0));
    vec2 whole = vec2(6.0 * side + 5.0 * gap, 2.0 * side + gap);
    vec2 place = vec2(texel) + 0.5 - floor(0.5 * (vec2(size) - whole));
    vec3 seen = srgb_from_linear(paper);
    int column = int(floor(place.x / (side + gap)));
    int row = int(floor(place.y / (side + gap)));
    vec2 part = (place - vec2(column, row) * (side + gap)) / side;
    bool inside = all(greaterThanEqual(part, vec2(0.0))) && all(lessThan(part, vec2(1.0)));
    if (inside && column >= 0 && column < 4 && row == 1) {
        vec3 tile = column == 0 ? shown_at(grass, part, side) : column == 1
                ? shown_at(rock, part, side)
                  : column == 2 ? shown_at(snow, part, side) : shown_at(path, part, side);
        seen = srgb_from_linear(tile);
    }
    if (inside && column >= 0 && column < 4 && row == 0) {
        vec4 weight = textureLod(weights, part,
                                 max(log2(float(textureSize(weights, 0).x) / side), 0.0));
        seen = vec3(column == 0 ? weight.x : column == 1 ? weight.y : column == 2 ? weight.z
                    : weight.w);
    }
    float large = 2.0 * side + gap;
    vec2 result = vec2(place.x - 4.0 * (side + gap), place.y) / large;
    if (all(greaterThanEqual(result, vec2(0.0))) && all(lessThan(result, vec2(1.0)))) {
        seen = srgb_from_linear(shown_at(colour, result, large) * shown_at(light, result, large));
    }
    return vec4(seen, 1.0);
}
