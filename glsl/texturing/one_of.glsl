// texturing/one_of.glsl -- one colour of four, chosen by its number.
//
//   gives    colour, linear light
//   needs    colours of any size; what is not wired is white
//   units    as the colours
//   source   none: a choice
//   tested   tests/glsl/test_texturing_base.py, against the colours themselves
//
// All that are wired are worked out; the choice between them costs nothing more. Give this
// pass the size of the finest: a coarser one is interpolated, as a view would do it.
#include "maths/drape.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D first;   //! input("linear", "white")
uniform sampler2D second;  //! input("linear", "white")
uniform sampler2D third;   //! input("linear", "white")
uniform sampler2D fourth;  //! input("linear", "white")
uniform int chosen = 0;    //! menu("first", "second", "third", "fourth") Which colour

vec4 read_at(sampler2D colour, ivec2 texel) {
    ivec2 texels = textureSize(colour, 0);
    if (texels == size) return texelFetch(colour, texel, 0);
    return textureLod(colour, drape_uv(share_of_texel(texel, size), texels), 0.0);
}

vec4 kernel(ivec2 texel) {
    if (chosen == 0) return read_at(first, texel);
    if (chosen == 1) return read_at(second, texel);
    if (chosen == 2) return read_at(third, texel);
    return read_at(fourth, texel);
}
