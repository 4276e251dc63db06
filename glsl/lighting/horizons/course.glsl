// lighting/horizons/course.glsl -- how a direction crosses a grid.
//
//   gives    Course, course_towards, drifted, offset_of, texel_of, pairs_of, pair_towards
//   needs    maths/angle.glsl
//   units    texels and rows of the grid; drift in 1/65536 of a texel a row; azimuths in degrees,
//            clockwise from north; tangents are rises over runs
//   source   the sweep along lines: Timonen and Westerholm 2010, "Scalable Height Field
//            Self-Shadowing", section 3; the eight directions: Belaiche 2010, section 3.4
//   tested   tests/glsl/test_horizons.py, against angles in float64
//
// A row is a line of texels across the axis that the direction follows more. Rows are counted
// towards the direction from the terrain's far edge. A line of sight drifts drift / 65536 texels
// to the side from one row to the next. That is a whole number so that every machine takes the
// same texels; over 4097 rows it is true to 0.03 texels. Parallel lines go through the middles of
// the texels of one row in the terrain's middle, so that opposite directions have the same lines.
#ifndef LIGHTING_HORIZONS_COURSE
#define LIGHTING_HORIZONS_COURSE
#include "maths/angle.glsl"

struct Course {
    bool along_x;   // the rows are the grid's columns
    bool upwards;   // the direction runs to the east, or to the north
    int drift;      // to the side, a row
    int rows;       // how many there are
    int across;     // texels of a row
    int middle;     // the row on which lines go through the middles of texels
    float rows_a_texel;  // rows on which it drifts one texel; many where it does not
    float steep;    // tangent for a height of 1 m on the next row  [1/m]
};

// The course towards a level direction, east and north, on a grid with so many metres a texel.
Course course_towards(vec2 towards, ivec2 grid, vec2 metres) {
    vec2 texels = towards / metres;
    bool along_x = abs(texels.x) >= abs(texels.y);
    float ahead = along_x ? texels.x : texels.y;
    float sideways = along_x ? texels.y : texels.x;
    int size_of_drift = int(floor(abs(sideways) / max(abs(ahead), 1e-30) * 65536.0 + 0.5));
    Course course;
    course.along_x = along_x;
    course.upwards = ahead >= 0.0;
    course.drift = sideways < 0.0 ? -size_of_drift : size_of_drift;
    course.rows_a_texel = size_of_drift == 0 ? 1e9 : 65536.0 / float(size_of_drift);
    course.rows = along_x ? grid.x : grid.y;
    course.across = along_x ? grid.y : grid.x;
    course.middle = course.upwards ? (course.rows - 1) >> 1 : course.rows >> 1;
    course.steep = abs(ahead);
    return course;
}

// How many whole texels a line has moved to the side on a row, to the nearest.
int drifted(Course course, int row) {
    return ((row - course.middle) * course.drift + 32768) >> 16;
}

// Where it is there, from the middle of that texel: -0.5 to 0.5.
float offset_of(Course course, int row) {
    return float((row - course.middle) * course.drift - (drifted(course, row) << 16))
            * (1.0 / 65536.0);
}

// The texel of a row.
ivec2 texel_of(Course course, int row, int at) {
    int along = course.upwards ? row : course.rows - 1 - row;
    return course.along_x ? ivec2(along, at) : ivec2(at, along);
}

// Pairs of opposite directions among so many: one, or a multiple of four. Other numbers of
// directions count as the next of these below, so that the eight chief ones are always among them.
int pairs_of(int directions) {
    return max((directions >> 3) << 2, 1);
}

// The level direction of a pair, from `first` counterclockwise; the other of the pair is opposite.
// The first four pairs are the eight chief directions, the others lie between them.
vec2 pair_towards(int pair, int pairs, float first) {
    int step_of = max(pairs >> 2, 1);
    int turn = pair < 4 ? pair * step_of : (pair & 3) * step_of + (pair >> 2);
    return cos_sin_degrees(first - 180.0 * float(turn) / float(pairs)).yx;
}
#endif
