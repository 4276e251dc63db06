// lighting/one_of.glsl -- one light of four, chosen by its number.
//
//   gives    light
//   needs    lights of any size; what is not wired is white
//   units    as the lights
//   source   none: a choice
//   tested   tests/glsl/test_one_of.py, against the lights themselves
//
// All that are wired are worked out; the choice between them costs nothing more. It is for
// looking at several methods on one terrain, one after another, with each method's own parameters
// kept.
#include "maths/land.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D first;   //! input("white")
uniform sampler2D second;  //! input("white")
uniform sampler2D third;   //! input("white")
uniform sampler2D fourth;  //! input("white")
uniform int chosen = 0;    //! menu("first", "second", "third", "fourth") Which light

// The texel nearest to where this one is.
vec4 read_at(sampler2D light, ivec2 texel) {
    return texelFetch(light, ivec2(place_on(textureSize(light, 0), texel, size) + 0.5), 0);
}

vec4 kernel(ivec2 texel) {
    if (chosen == 0) return read_at(first, texel);
    if (chosen == 1) return read_at(second, texel);
    if (chosen == 2) return read_at(third, texel);
    return read_at(fourth, texel);
}
