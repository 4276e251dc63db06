// lighting/horizons/lines.glsl -- the lines of a sweep, and what it leaves on them for the sums.
//
//   gives    Batch, batch_at, first_line, place_of, land_at, own_row, far_row, sees, tangent_at,
//            UP_TO_4, UP_TO_8, CHUNK; in a compute variant only
//   needs    lighting/horizons/course.glsl, maths/whole.glsl; size, directions, the buffers of
//            lighting/horizons.comp and its output terrain
//   units    texels and rows; heights without unit; tangents: rise over run
//   source   Timonen and Westerholm 2010, as lighting/horizons.comp
//   tested   tests/glsl/test_horizons.py, against brute force in float64 and against the march
#ifndef LIGHTING_HORIZONS_LINES
#define LIGHTING_HORIZONS_LINES
#ifdef COMPUTE_STAGE
#include "lighting/horizons/course.glsl"
#include "maths/whole.glsl"

const int CHUNK = 64;           // rows of the terrain that a thread sums

// What is done for each of several rows is written out: an array whose index is a loop's counter
// would lie in memory.
#define UP_TO_4(DO) DO(0) DO(1) DO(2) DO(3)
#define UP_TO_8(DO) UP_TO_4(DO) DO(4) DO(5) DO(6) DO(7)

// How the pairs of directions are shared out over batches. No buffer may be larger than
// 128 MiB on some drivers, and the widest terrains need that for one pair, so there are two.
struct Batch {
    int pairs;      // in all
    int from, end;  // those of this one
    int apart;      // in a buffer, from one pair to the next
};

// The batches after those that are needed have no pairs.
Batch batch_at(int number) {
    Batch batch;
    batch.pairs = pairs_of(directions);
    batch.apart = (size.x + 32) * (size.y + 32) / 4;
    int room = 2 * (even_lines.length() / batch.apart);
    int batches = (batch.pairs + room - 1) / room;
    int pairs_each = ((batch.pairs + 1) / 2 + batches - 1) / batches * 2;
    batch.from = min(number * pairs_each, batch.pairs);
    batch.end = min(batch.from + pairs_each, batch.pairs);
    return batch;
}

// Line 0 is the one before the first that meets the terrain: what a texel sees beside it counts.
int first_line(Course course) {
    return -1 - max(drifted(course, 0), drifted(course, course.rows - 1));
}

// Where a group of four lines has a row: four texels, each with what is ahead of it in the lower
// half and what is behind in the upper. As many groups as can be on a row have room, and as many
// more as can leave it within a block; beyond these the room is used again.
int place_of(Course course, int group, int row) {
    int groups = (course.across + 31) >> 2;
    return (group - groups * quotient(group, groups)) * course.rows + row;
}

float land_at(ivec2 texel) {
    return imageLoad(out_land, texel).r;
}

// Where a texel sees its horizon, and where its line sees the highest far row, which is the same
// unless a near row hides it: the texel beside may see over that. In 16 bits: a distance, or a
// near one from 1 to 16 and of the far one eleven bits, as a float has them: true to a 128th.
const int NEAR_WINS = 0x8000;
const int MOST_REST = 0x0800;
const int SEVEN_BITS = 127 << 7;  // the exponent of 1

int own_row(int word) {
    return word < NEAR_WINS ? word : ((word >> 11) & 15) + 1;
}

int far_row(int word) {
    if (word < NEAR_WINS) return word;
    return int(intBitsToFloat(((word & (MOST_REST - 1)) + SEVEN_BITS) << 16));
}

// Whether a texel's own line of sight is still on the terrain on the row d further on: as the
// march has it.
bool sees(Course course, int row, int across, int d) {
    float place = float(across) + float(d) * (float(course.drift) * (1.0 / 65536.0));
    return row + d < course.rows && place >= -0.5 && place <= float(course.across) - 0.5;
}

// The tangent of what it meets there, for heights of 1.
float tangent_at(Course course, int row, int across, int d, float foot) {
    float place = float(across) + float(d) * (float(course.drift) * (1.0 / 65536.0));
    float held = clamp(place, 0.0, float(course.across - 1));
    int low = int(held);
    int there = min(row + d, course.rows - 1);
    float from = land_at(texel_of(course, there, low));
    float to = land_at(texel_of(course, there, min(low + 1, course.across - 1)));
    return (from + (to - from) * (held - float(low)) - foot) * course.steep / float(max(d, 1));
}
#endif
#endif
