// What GLSL ES 3.00 (section 8.4) and GLSL 4.20 pack and unpack, by whole numbers, in GLSL 3.30.
// Half floats are IEEE 754 binary16, rounded to nearest, ties to even.
#define packHalf2x16 k_pack_half
#define unpackHalf2x16 k_unpack_half
#define packSnorm2x16 k_pack_snorm
#define unpackSnorm2x16 k_unpack_snorm
#define packUnorm2x16 k_pack_unorm
#define unpackUnorm2x16 k_unpack_unorm
uint k_rounded_shift(uint k_bits, uint k_shift) {
    uint k_whole = k_bits >> k_shift, k_rest = k_bits & ((1u << k_shift) - 1u), k_half = 1u << (k_shift - 1u);
    return k_whole + (k_rest > k_half || (k_rest == k_half && (k_whole & 1u) == 1u) ? 1u : 0u);
}
uint k_half_of(float k_value) {
    uint k_bits = floatBitsToUint(k_value);
    uint k_sign = (k_bits >> 16) & 0x8000u, k_size = k_bits & 0x7FFFFFFFu, k_exponent = k_size >> 23;
    if (k_size > 0x7F800000u) return k_sign | 0x7E00u;        // NaN
    if (k_size >= 0x47800000u) return k_sign | 0x7C00u;       // 65536 and more
    if (k_exponent >= 113u) return k_sign | k_rounded_shift(k_size - 0x38000000u, 13u);
    if (k_exponent < 102u) return k_sign;                     // less than half of the least, 2^-24
    return k_sign | k_rounded_shift((k_size & 0x7FFFFFu) | 0x800000u, 126u - k_exponent);
}
float k_float_of(uint k_half) {
    uint k_sign = (k_half & 0x8000u) << 16, k_exponent = (k_half >> 10) & 31u, k_rest = k_half & 0x3FFu;
    if (k_exponent == 31u) return uintBitsToFloat(k_sign | 0x7F800000u | (k_rest << 13));
    if (k_exponent > 0u) return uintBitsToFloat(k_sign | ((k_exponent + 112u) << 23) | (k_rest << 13));
    return uintBitsToFloat(k_sign | floatBitsToUint(float(k_rest) * 5.9604644775390625e-8));  // 2^-24
}
uint k_pack_half(vec2 k_values) { return k_half_of(k_values.x) | (k_half_of(k_values.y) << 16); }
vec2 k_unpack_half(uint k_pair) { return vec2(k_float_of(k_pair & 0xFFFFu), k_float_of(k_pair >> 16)); }
uint k_pack_unorm(vec2 k_values) {
    uvec2 k_codes = uvec2(roundEven(clamp(k_values, 0.0, 1.0) * 65535.0));
    return k_codes.x | (k_codes.y << 16);
}
vec2 k_unpack_unorm(uint k_pair) { return vec2(k_pair & 0xFFFFu, k_pair >> 16) / 65535.0; }
uint k_pack_snorm(vec2 k_values) {
    uvec2 k_codes = uvec2(ivec2(roundEven(clamp(k_values, -1.0, 1.0) * 32767.0))) & 0xFFFFu;
    return k_codes.x | (k_codes.y << 16);
}
vec2 k_unpack_snorm(uint k_pair) {
    ivec2 k_codes = ivec2(int(k_pair << 16), int(k_pair)) >> 16;
    return clamp(vec2(k_codes) / 32767.0, -1.0, 1.0);
}
