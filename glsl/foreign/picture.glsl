// foreign/picture.glsl -- a test card, where nothing feeds a picture of another tool's shader.
//
//   gives    channel_texels, colours encoded for the display
//   needs    nothing
//   units    none
//   source   made here
//   tested   tests/glsl/test_foreign.py: numbers differ, west and east and south and north do too
//
// Red grows eastwards and green northwards, so that a picture upside down shows as one; eight
// squares a side show how a shader stretches it. The tint tells the numbers apart: steps of the
// golden ratio around the colour circle never meet.
#pragma kernel(output = "channel_texels:rgba8")

uniform int number = 0;  //! slider(0, 99) Which picture: each has a tint of its own

vec4 kernel(ivec2 texel) {
    vec2 place = (vec2(texel) + 0.5) / vec2(size);
    float turn = 0.618034 * float(number);
    vec3 tint = 0.5 + 0.5 * cos(6.2831853 * (turn + vec3(0.0, 1.0, 2.0) / 3.0));
    ivec2 square = ivec2(floor(place * 8.0));
    float shade = ((square.x + square.y) & 1) == 0 ? 1.0 : 0.7;
    return vec4(mix(vec3(place, 0.3), tint, 0.4) * shade, 1.0);
}
