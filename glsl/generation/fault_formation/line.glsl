// generation/fault_formation/line.glsl -- a fault's line, and on which side of it a place lies.
//
//   gives    PLACES, place_of_texel, fault_line, fault_value, fault_edge, is_raised, fault_unit
//   needs    maths/whole.glsl
//   units    places in 32768ths of the terrain's sides, east and north, so that a line does not
//            depend on the terrain's size; a line's points in 4096ths of them
//   source   Belaiche 2010, section 1.3.6; the whole numbers: made here
//   tested   tests/glsl/test_marks.py, against cross products of Python's own integers
//
// A line is three whole numbers: its direction turned left by 90 degrees, and its first point,
// packed. Nothing is rounded, so every form of the sum agrees on the side of every texel, also of
// those on the line itself; and the same line from its second point to its first has its
// sides exchanged, everywhere.
#ifndef GENERATION_FAULT_FORMATION_LINE
#define GENERATION_FAULT_FORMATION_LINE
#include "maths/whole.glsl"

const int PLACES = 32768;  // of a side

// Where a texel of a row (or column) of `side` texels is, 0..32768.
int place_of_texel(int texel, int side) {
    int last = max(side - 1, 1);
    return quotient(texel * PLACES + (last >> 1), last);
}

// The line through two points, 0..4095 along both axes: all of them inside the terrain, none on
// its border, so that each line parts the terrain's corners. Through one point twice it goes east.
ivec3 fault_line(ivec2 first, ivec2 second) {
    ivec2 along = second - first;
    if (along == ivec2(0)) along = ivec2(1, 0);
    return ivec3(-along.y, along.x, first.x + (first.y << 12));
}

// Above 0 to the left of the line, below 0 to its right; less than 2^29.
// anchor: side
int fault_value(ivec3 line, ivec2 place) {
    ivec2 point = ivec2(line.z & 4095, line.z >> 12) * 8 + 4;
    ivec2 offset = place - point;
    return line.x * offset.x + line.y * offset.y;
}
// end: side

// Which side the line's own texels belong to: 1 for the raised. It changes with the line's
// direction.
int fault_edge(ivec3 line) {
    return line.y * 8192 + line.x > 0 ? 1 : 0;
}

bool is_raised(ivec3 line, ivec2 place) {
    return fault_value(line, place) + fault_edge(line) > 0;
}

// The height that all heights of a terrain are multiples of: a power of two, so small that it is
// invisible, so large that a sum of all faults is below 2^23 of it. Such sums are exact in floats.
float fault_unit(int faults, float amount) {
    int above = (floatBitsToInt(float(max(faults, 1)) * amount) >> 23) + 1;
    return intBitsToFloat((above - 23) << 23);
}
#endif
