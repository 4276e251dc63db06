// maths/fourier.glsl -- Fourier transforms of 32 numbers that one thread holds, or of blocks.
//
//   gives    transform32, place32, transform_blocks, transform_blocks_back, block_number,
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

// exp(-2 pi i k / 32).
const vec2 ROOTS_32[32] = vec2[32](
    vec2(1.0, 0.0), vec2(0.980785280, -0.195090322),
    vec2(0.923879533, -0.382683432), vec2(0.831469612, -0.555570233),
    vec2(0.707106781, -0.707106781), vec2(0.555570233, -0.831469612),
    vec2(0.382683432, -0.923879533), vec2(0.195090322, -0.980785280),
    vec2(0.0, -1.0), vec2(-0.195090322, -0.980785280),
    vec2(-0.382683432, -0.923879533), vec2(-0.555570233, -0.831469612),
    vec2(-0.707106781, -0.707106781), vec2(-0.831469612, -0.555570233),
    vec2(-0.923879533, -0.382683432), vec2(-0.980785280, -0.195090322),
    vec2(-1.0, 0.0), vec2(-0.980785280, 0.195090322),
    vec2(-0.923879533, 0.382683432), vec2(-0.831469612, 0.555570233),
    vec2(-0.707106781, 0.707106781), vec2(-0.555570233, 0.831469612),
    vec2(-0.382683432, 0.923879533), vec2(-0.195090322, 0.980785280),
    vec2(0.0, 1.0), vec2(0.195090322, 0.980785280),
    vec2(0.382683432, 0.923879533), vec2(0.555570233, 0.831469612),
    vec2(0.707106781, 0.707106781), vec2(0.831469612, 0.555570233),
    vec2(0.923879533, 0.382683432), vec2(0.980785280, 0.195090322));

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

// The transforms of sixteen, from v[first] on; number k is at first + (4 (k mod 4) + k / 4).
void transform16(inout vec4 v[32], int first) {
    for (int i = 0; i < 4; i++) {
        int a = first + i;
        transform4(v[a], v[a + 4], v[a + 8], v[a + 12]);
        v[a + 4] = both_products(v[a + 4], ROOTS_32[2 * i]);
        v[a + 8] = both_products(v[a + 8], ROOTS_32[4 * i]);
        v[a + 12] = both_products(v[a + 12], ROOTS_32[6 * i]);
    }
    for (int i = 0; i < 4; i++) {
        int a = first + 4 * i;
        transform4(v[a], v[a + 1], v[a + 2], v[a + 3]);
    }
}

// The transform of 32; number k of it is at place32(k).
void transform32(inout vec4 v[32]) {
    for (int i = 0; i < 16; i++) {
        vec4 difference = v[i] - v[i + 16];
        v[i] += v[i + 16];
        v[i + 16] = both_products(difference, ROOTS_32[i]);
    }
    transform16(v, 0);  // the even numbers
    transform16(v, 16);
}

int place32(int k) {
    return ((k & 1) << 4) | ((k & 6) << 1) | (k >> 3);
}

// One level of butterflies between numbers `span` apart, or nothing.
void level(inout vec4 v[32], int span, bool wanted) {
    for (int i = 0; i < 16; i++) {
        int low = ((i & ~(span - 1)) << 1) | (i & (span - 1));
        vec4 a = v[low];
        vec4 b = v[low + span];
        vec4 difference = both_products(a - b, ROOTS_32[(i & (span - 1)) * (16 / span)]);
        v[low] = wanted ? a + b : a;
        v[low + span] = wanted ? difference : b;
    }
}

// The transforms of blocks of 2^levels numbers, side by side, levels 0 to 5. At each place
// is then the number of its block that block_number returns.
void transform_blocks(inout vec4 v[32], int levels) {
    level(v, 16, levels > 4);
    level(v, 8, levels > 3);
    level(v, 4, levels > 2);
    level(v, 2, levels > 1);
    level(v, 1, levels > 0);
}

int block_number(int place, int levels) {
    int reversed = ((place & 1) << 4) | ((place & 2) << 2) | (place & 4)
                 | ((place & 8) >> 2) | ((place & 16) >> 4);
    return reversed >> (5 - levels);
}

void level_back(inout vec4 v[32], int span, bool wanted) {
    for (int i = 0; i < 16; i++) {
        int low = ((i & ~(span - 1)) << 1) | (i & (span - 1));
        vec4 a = v[low];
        vec4 b = v[low + span];
        vec4 turned = both_products(b, ROOTS_32[(i & (span - 1)) * (16 / span)]);
        v[low] = wanted ? a + turned : a;
        v[low + span] = wanted ? a - turned : b;
    }
}

// Forward as well, but from numbers in the order that transform_blocks leaves them in
// to numbers in order.
void transform_blocks_back(inout vec4 v[32], int levels) {
    level_back(v, 1, levels > 0);
    level_back(v, 2, levels > 1);
    level_back(v, 4, levels > 2);
    level_back(v, 8, levels > 3);
    level_back(v, 16, levels > 4);
}
#endif
