// texturing/mipmaps/pattern.glsl -- a tile in two colours that continues into itself.
//
//   gives    colour, linear light: a tile that continues into itself
//   needs    noise/periodic.glsl
//   units    none
//   source   none: made here
//   tested   tests/glsl/test_mipmaps.py: a chessboard's mean, and hills that repeat
#include "noise/periodic.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform int pattern = 0;    //! menu("squares", "hills", "hills over 0.6")
                            //! A chessboard, hills as shades of grey, or only what of them is high
uniform int squares = 8;    //! slider(2, 64)
                            //! How many squares, or hills, lie side by side in a tile
uniform int seed = 7;       //! slider(0, 9999) Chooses the hills

const uint SALT = 0x5726b7cdu;  // CRC-32 of "lessons/pattern"

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size) * float(squares);
    ivec2 square = ivec2(place);
    float hill = value_noise_periodic(place, ivec2(squares), uint(seed) + SALT);
    float chessboard = float((square.x + square.y) & 1);
    float shown = pattern == 0 ? chessboard : pattern == 1 ? hill : step(0.6, hill);
    return vec4(vec3(shown), 1.0);
}
