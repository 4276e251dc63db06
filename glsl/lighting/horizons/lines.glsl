// lighting/horizons/lines.glsl -- the lines of a sweep, and what it leaves on them for the sums.
//
//   gives    Batch, batch_at, first_line, place_of, halves_of, from_halves, land_at, MAX_TANGENT,
//            CHUNK; in a compute variant only
//   needs    lighting/horizons/course.glsl, maths/whole.glsl; size, directions, the buffers of
//            lighting/horizons.comp and its output terrain
//   units    texels and rows; heights without unit; tangents: rise over run, 0 to 60000
//   source   Timonen and Westerholm 2010, as lighting/horizons.comp
//   tested   tests/glsl/test_horizons.py, against brute force in float64 and against the march
#ifndef LIGHTING_HORIZONS_LINES
#define LIGHTING_HORIZONS_LINES
#ifdef COMPUTE_STAGE
#include "lighting/horizons/course.glsl"
#include "maths/whole.glsl"

const int CHUNK = 64;               // rows of the terrain that a thread sums
const float MAX_TANGENT = 60000.0;  // that a half float holds

// How the pairs of directions are shared out over batches. No buffer may be larger than
// 128 MiB on some drivers.
struct Batch {
    int pairs;      // in all
    int counted;    // of these, in K
    int from, end;  // those of this one
    int stride;     // in the buffer, from one direction to the next
};

// The batches after those that are needed have no pairs.
Batch batch_at(int number) {
    Batch batch;
    batch.counted = pairs_of(directions);
    batch.pairs = keep ? max(batch.counted, 4) : batch.counted;
    batch.stride = (size.x + 32) * (size.y + 32) / 8;
    int room = lines.length() / (2 * batch.stride);
    int batches = (batch.pairs + room - 1) / room;
    int pairs_each = (batch.pairs + batches - 1) / batches;
    batch.from = min(number * pairs_each, batch.pairs);
    batch.end = min(batch.from + pairs_each, batch.pairs);
    return batch;
}

// Line 0 is the first that a texel of the terrain is on.
int first_line(Course course) {
    return -max(drifted(course, 0), drifted(course, course.rows - 1));
}

// Where a group of four lines has a row and the next, an even one and an odd: of each four
// tangents in two words. As many groups as can be on a row have room, and as many more as can
// leave it within a block; beyond these the room is used again.
int place_of(Course course, int group, int row) {
    int groups = (course.across + 31) >> 2;
    int pairs_of_rows = ((course.rows + 7) >> 3) << 2;
    return (group - groups * quotient(group, groups)) * pairs_of_rows + (row >> 1);
}

// Tangents in 16 bits each, rounded to what a half float holds; those below 2^-14 may be 0. It is
// two instructions, where packHalf2x16 and its opposite are tens on a software renderer.
const float OF_HALF = 1.92592994e-34;  // 2^-112, which makes a float's exponent that of a half
const float FROM_HALF = 5.19229686e33;  // 2^112

uvec4 halves_of(vec4 tangents) {
    return (floatBitsToUint(tangents * OF_HALF) + 0x1000u) >> 13;
}

vec2 from_halves(uvec2 halves) {
    return uintBitsToFloat((halves & 0xffffu) << 13) * FROM_HALF;
}

float land_at(ivec2 texel) {
    return imageLoad(out_land, texel).r;
}
#endif
#endif
