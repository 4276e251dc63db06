// noise/hash.glsl -- random numbers from whole numbers: the same on every driver, for ever.
//
//   gives    hash3, random, random_pair, random_signed
//   needs    nothing: pure functions, no uniforms, no textures
//   units    numbers in [0, 1), or [-1, 1) where signed
//   source   pcg3d of Jarzynski and Olano 2020, "Hash Functions for GPU
//            Rendering", Journal of Computer Graphics Techniques 9(3), listing in
//            the section on PCG; whole-number arithmetic modulo 2^32 only
//   tested   tests/glsl/test_noise.py, against the same arithmetic in Python and
//            against the statistics that random numbers must have
//
// A sine-based hash differs from driver to driver and repeats far from the origin;
// whole numbers do neither. The key is a lattice point and a seed, so a number does not
// depend on the order in which numbers are computed.
//
// Whoever draws adds a salt of its own to the seed, the CRC-32 of its name:
//     const uint SALT = 0x93e2094du;  // CRC-32 of "generation/white_noise"
//     ... random(texel, seed + SALT) ...
// Without it two techniques of one seed would draw the same numbers at the same points, and
// their sum or product would be that of a terrain with itself. Python gives the number:
//     python -c "import zlib; print(hex(zlib.crc32(b'generation/white_noise')))"
#ifndef NOISE_HASH
#define NOISE_HASH

// Mix three whole numbers; each bit of the result depends on every bit of the key.
uvec3 hash3(uvec3 key) {
    key = key * 1664525u + 1013904223u;
    key.x += key.y * key.z;
    key.y += key.z * key.x;
    key.z += key.x * key.y;
    key ^= key >> 16u;
    key.x += key.y * key.z;
    key.y += key.z * key.x;
    key.z += key.x * key.y;
    return key;
}

// The upper 24 bits fill a float's mantissa exactly, so every value is a multiple of 2^-24.
float unit_from_bits(uint bits) {
    return float(bits >> 8u) * (1.0 / 16777216.0);
}

// One number in [0, 1) for a lattice point and a seed.
float random(ivec2 point, uint seed) {
    return unit_from_bits(hash3(uvec3(uint(point.x), uint(point.y), seed)).x);
}

// Two independent numbers in [0, 1).
vec2 random_pair(ivec2 point, uint seed) {
    uvec3 bits = hash3(uvec3(uint(point.x), uint(point.y), seed));
    return vec2(unit_from_bits(bits.x), unit_from_bits(bits.y));
}

// One number in [-1, 1).
float random_signed(ivec2 point, uint seed) {
    return random(point, seed) * 2.0 - 1.0;
}
#endif
