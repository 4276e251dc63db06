// terrain/order.glsl -- heights as whole numbers in the same order.
//
//   gives    key_of_height, height_of_key
//   needs    nothing: pure functions, no uniforms, no textures
//   units    heights as they are; keys 32 bits, for atomicMax
//   source   derived here: the bits of positive floats are in order, those of negative ones in
//            the reverse order
//   tested   tests/glsl/test_halving.py, against sorting
//
// The highest of several heights has the greatest key, the lowest the greatest ~key. No
// height has the key 0 or the ~key 0, so a buffer of zeros holds nothing yet.
#ifndef TERRAIN_ORDER
#define TERRAIN_ORDER

uint key_of_height(float h) {
    uint bits = floatBitsToUint(h);
    return (bits & 0x80000000u) != 0u ? ~bits : bits | 0x80000000u;
}

float height_of_key(uint key) {
    return uintBitsToFloat((key & 0x80000000u) != 0u ? key & 0x7fffffffu : ~key);
}
#endif
