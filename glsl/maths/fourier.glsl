// maths/fourier.glsl -- Fourier transforms of sixteen numbers that one thread holds, or blocks.
//
//   gives    transform16, place16, transform_blocks, transform_blocks_back, block_number,
//            both_products
//   needs    nothing: pure functions, no uniforms, no textures
//   units    as the numbers: sums with exp(-2 pi i j k / count), not divided by anything
//   source   Cooley and Tukey 1965, "An Algorithm for the Machine Calculation of Complex
//            Fourier Series", Mathematics of Computation 19(90), in radix 4 and radix 2
//   tested   tests/glsl/test_fourier.py, against NumPy
//
// A vec4 is two complex numbers, each of a transform of its own.
#ifndef MATHS_FOURIER
#define MATHS_FOURIER

// exp(-2 pi i k / 16).
const vec2 ROOTS_16[16] = vec2[16](
    vec2(1.0, 0.0), vec2(0.923879533, -0.382683432),
    vec2(0.707106781, -0.707106781), vec2(0.382683432, -0.923879533),
    vec2(0.0, -1.0), vec2(-0.382683432, -0.923879533),
    vec2(-0.707106781, -0.707106781), vec2(-0.923879533, -0.382683432),
    vec2(-1.0, 0.0), vec2(-0.923879533, 0.382683432),
    vec2(-0.707106781, 0.707106781), vec2(-0.382683432, 0.923879533),
    vec2(0.0, 1.0), vec2(0.382683432, 0.923879533),
    vec2(0.707106781, 0.707106781), vec2(0.923879533, 0.382683432));

// Both complex numbers of a pair times the same complex factor.
vec4 both_products(vec4 pair, vec2 factor) {
    return pair * factor.x + vec4(-pair.y, pair.x, -pair.w, pair.z) * factor.y;
}

// The transform of four, in order.
void transform4(inout vec4 a, inout vec4 b, inout vec4 c, inout vec4 d) {
    vec4 even = a + c;
    vec4 even_rest = a - c;
    vec4 odd = b + d;
    vec4 odd_rest = vec4(b.y - d.y, d.x - b.x, b.w - d.w, d.z - b.z);  // times -i
    a = even + odd;
    b = even_rest + odd_rest;
    c = even - odd;
    d = even_rest - odd_rest;
}

// The transform of sixteen; number k of it is at place16(k).
void transform16(inout vec4 v[16]) {
    for (int i = 0; i < 4; i++) {
        transform4(v[i], v[i + 4], v[i + 8], v[i + 12]);
        v[i + 4] = both_products(v[i + 4], ROOTS_16[i]);
        v[i + 8] = both_products(v[i + 8], ROOTS_16[2 * i]);
        v[i + 12] = both_products(v[i + 12], ROOTS_16[3 * i]);
    }
    for (int i = 0; i < 4; i++) transform4(v[4 * i], v[4 * i + 1], v[4 * i + 2], v[4 * i + 3]);
}

int place16(int k) {
    return ((k & 3) << 2) | (k >> 2);
}

// One level of butterflies between numbers `span` apart, or nothing.
void level(inout vec4 v[16], int span, bool wanted) {
    for (int i = 0; i < 8; i++) {
        int low = ((i & ~(span - 1)) << 1) | (i & (span - 1));
        vec4 a = v[low];
        vec4 b = v[low + span];
        vec4 difference = both_products(a - b, ROOTS_16[(i & (span - 1)) * (8 / span)]);
        v[low] = wanted ? a + b : a;
        v[low + span] = wanted ? difference : b;
    }
}

// The transforms of blocks of 2^levels numbers, side by side, levels 0 to 4. At each place
// is then the number of its block that block_number returns.
void transform_blocks(inout vec4 v[16], int levels) {
    level(v, 8, levels > 3);
    level(v, 4, levels > 2);
    level(v, 2, levels > 1);
    level(v, 1, levels > 0);
}

int block_number(int place, int levels) {
    int reversed = ((place & 1) << 3) | ((place & 2) << 1)
                 | ((place & 4) >> 1) | ((place & 8) >> 3);
    return reversed >> (4 - levels);
}

void level_back(inout vec4 v[16], int span, bool wanted) {
    for (int i = 0; i < 8; i++) {
        int low = ((i & ~(span - 1)) << 1) | (i & (span - 1));
        vec4 a = v[low];
        vec4 b = v[low + span];
        vec4 turned = both_products(b, ROOTS_16[(i & (span - 1)) * (8 / span)]);
        v[low] = wanted ? a + turned : a;
        v[low + span] = wanted ? a - turned : b;
    }
}

// Forward as well, but from numbers in the order that transform_blocks leaves them in
// to numbers in order.
void transform_blocks_back(inout vec4 v[16], int levels) {
    level_back(v, 1, levels > 0);
    level_back(v, 2, levels > 1);
    level_back(v, 4, levels > 2);
    level_back(v, 8, levels > 3);
}
#endif
