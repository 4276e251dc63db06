// generation/marks.glsl -- which of many things touch a tile of the terrain: 96 marks in a texel.
//
//   gives    MARKS, MARKS_A_CHANNEL, tile_grid, Marks, marks_of, some_left, next_mark
//   needs    maths/bits.glsl, maths/whole.glsl
//   units    things by their number, from 0; tiles counted east and north
//   source   made here; bins of lights by tile, as in O. Olsson and U. Assarsson 2011, "Tiled
//            Shading" (Journal of Graphics, GPU, and Game Tools 15)
//   tested   tests/glsl/test_marks.py: the terrain is
//            the one without tiles
//
// Only for speed: a kernel that adds up many things asks for few of them at each texel. A texel
// of 32 bit floats holds 24 whole bits in each channel. A texture of marks holds, from west to
// east, all tiles for things 0 to 95, then all for the next 96, and so on.
#ifndef GENERATION_MARKS
#define GENERATION_MARKS
#include "maths/bits.glsl"
#include "maths/whole.glsl"

const int MARKS = 96;
const int MARKS_A_CHANNEL = 24;

// How many tiles there are along x and y, and how many times side by side.
ivec3 tile_grid(ivec2 texels, int things) {
    int blocks = max(quotient(things + MARKS - 1, MARKS), 1);
    return ivec3(max(quotient(texels.x, blocks), 1), texels.y, blocks);
}

struct Marks {
    uint bits;   // of the channel that is being read
    uvec3 rest;  // of the channels after it
    int first;   // the thing that the lowest of `bits` represents
};

Marks marks_of(vec4 texel, int first) {
    uvec4 bits = uvec4(texel);
    return Marks(bits.x, bits.yzw, first);
}

bool some_left(Marks marks) {
    return (marks.bits | marks.rest.x | marks.rest.y | marks.rest.z) != 0u;
}

// The next thing that is marked, which is taken out; -1 for a channel without one. So one loop is
// for the four channels: four loops cost a third more.
int next_mark(inout Marks marks) {
    if (marks.bits == 0u) {
        marks = Marks(marks.rest.x, uvec3(marks.rest.yz, 0u), marks.first + MARKS_A_CHANNEL);
    }
    if (marks.bits == 0u) return -1;
    int which = marks.first + lowest_bit(marks.bits);
    marks.bits &= marks.bits - 1u;
    return which;
}
#endif
