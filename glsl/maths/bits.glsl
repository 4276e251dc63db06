// maths/bits.glsl -- the lowest bit that is set in a whole number.
//
//   gives    lowest_bit
//   needs    nothing: pure functions, no uniforms, no textures
//   units    bits are counted from 0
//   source   a float's exponent is a power of two's logarithm (IEEE 754); GLSL 3.30 has no findLSB
//   tested   tests/glsl/test_marks.py, against Python's bit_length
#ifndef MATHS_BITS
#define MATHS_BITS

// Of 0 it is -127, of no use.
int lowest_bit(uint bits) {
    uint lowest = bits & (~bits + 1u);
    return (floatBitsToInt(float(lowest)) >> 23) - 127;
}
#endif
