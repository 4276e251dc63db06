// lighting/horizons/sweep.glsl -- sweeps along lines: how steeply each texel sees its horizon.
//
//   gives    sweep; in a compute variant only
//   needs    lighting/horizons/lines.glsl; first, extent, relief, the buffers of
//            lighting/horizons.comp
//   units    texels and rows; heights without unit; slopes for rows 1 m apart and heights of 1
//   source   Timonen and Westerholm 2010, "Scalable Height Field Self-Shadowing", section 3
//   tested   tests/glsl/test_horizons.py, against brute force in float64 and against the march
//
// A line runs up to half a texel from the middle of a texel, and what it sees highest need not be
// as high for the texel. So the lines only choose the rows: at each of these the texel looks on
// its own line of sight, and interpolates between texels as the march does.
//
// A thread has four adjacent lines, and moves back along them in blocks of eight rows:
//   1. The rows of the block look at every row after them in the window: the block and the
//      sixteen rows beyond it. At this distance a line would see other terrain than the texel.
//   2. They look at the points of the line's upper hull from its near end on, as long as the next
//      point shows more to one of them. Points that rows of the block cover are dropped.
//   3. They look at the uncertain rows that may be visible: no single height on the line is true
//      for all lines of sight along it.
//   4. The window's last eight rows are pushed on the hull.
// The hull is a stack of words in a buffer, one a block: a bit for each row on the hull and, in
// the upper half, the number of the word below. The list of uncertain rows has the same form.
// Both begin beyond the window.
//
// The error is bounded on any terrain. Lines of sight cross row k between heights L(k) and U(k),
// the extremes up to half a texel to either side of the line. With a tolerance t, the line's own
// height is c(k) = min(crossing, L(k) + t), so that
//     c(k) <= h(k) + t    for each line of sight, which crosses the row at h(k);            (1)
//     h(k) <= c(k) + t    on each row that is certain: U(k) <= c(k) + t.                    (2)
// From height h a texel looks at point q of the hull of all c, where the slope m = (c(q) - h) / q
// is greatest: by (1) it finds a slope of at least m - t/q. By (2) a certain row p has a slope of
// at most m + t/p. Both are over 16 rows away: t = 8.5 e makes the difference at most e. An
// uncertain row is passed over only where U(k) <= h + (found + e/10) k, so that it is over the
// slope found by even less. With e = MAX_ERROR as a tangent the elevation is too low by at most
// atan(MAX_ERROR) = 2.86 degrees; it is never too high, since all slopes found are the march's
// own.
// Lines along axes and diagonals of the grid are the lines of sight: L = U, and nothing is lost.
// A line leaves the terrain up to half a texel after some of the lines of sight along it, or
// before: the rows between are uncertain, and are not on the hull.
//
// Loops over the window have the length of the array that they index: compilers then unroll them,
// and the arrays need no memory.
#ifndef LIGHTING_HORIZONS_SWEEP
#define LIGHTING_HORIZONS_SWEEP
#ifdef COMPUTE_STAGE
#include "lighting/horizons/lines.glsl"

const int BLOCK = 8;            // rows of a block, and bits of a word of the hull
const int NEAR = 16;            // rows that every row looks at
const int WINDOW = BLOCK + NEAR;
const float NONE = -1e30;       // a height that hides nothing
const float MAX_ERROR = 0.05;   // of a horizon's tangent, on any terrain
const float MIN_GAIN = 0.1;     // of that error, for which an uncertain row is looked at

// The window: the block's rows, then the nearest rows of the blocks before, on four lines. Beyond
// its edge the terrain is as high as there.
vec4 texels[WINDOW];      // heights of the texels nearest to the lines
vec4 rises[WINDOW];       // from each of these to the next texel of the row
float first_rise[WINDOW]; // to the first of them from the texel before it
float offsets[WINDOW];    // from the middles of the texels to the lines, -0.5 to 0.5
vec4 crossings[WINDOW];   // c, the heights of the lines
vec4 rows_to_edge[BLOCK]; // until the texels' own lines of sight leave the terrain
// The steepest slope that the texels see, 0 or more, as bits: their maximum is one instruction,
// that of floats also tests for NaN.
ivec4 horizons[BLOCK];

// The uncertain rows of the block on each line: a bit for each, and U of the highest.
ivec4 uncertain_rows;
vec4 highest_in_block;

float highest_uncertain[4];  // U of the highest uncertain row so far
float error_a_row;           // MAX_ERROR as a height on the next row
float half_width;            // from a line to the outermost lines of sight along it

// A row that one line looks at: the heights around the line.
struct Point {
    float texel;       // of the texel nearest to the line
    float rise_after;  // from it to the next texel of the row
    float rise_before; // to it from the texel before
    float offset;      // from the middle of the texel to the line
    float crossing;    // c
    float distance;    // in rows, from the first of the block
};

// The top of a line's hull.
struct Top {
    int word;
    int block;  // the number of the word; -1 for an empty hull
    int below;  // the word below, at hand: a buffer's latency is longer than a point's work
};

// c, L and U of a row.
struct Crossing {
    vec4 height;
    vec4 lowest;
    vec4 highest;
};

// Up to this difference a line's height is as good as that of each line of sight along it.
float tolerance() {
    return 0.5 * float(NEAR + 1) * error_a_row;
}

Crossing crossing_at(vec4 texel, vec4 rise_before, vec4 rise_after, float offset) {
    vec4 left = texel + min(offset - half_width, 0.0) * rise_before;
    vec4 right = texel + max(offset + half_width, 0.0) * rise_after;
    Crossing crossing;
    crossing.lowest = min(texel, min(left, right));
    crossing.highest = max(texel, max(left, right));
    crossing.height = min(texel + offset * (offset > 0.0 ? rise_after : rise_before),
                          crossing.lowest + tolerance());
    return crossing;
}

void clear_row(int row) {
    texels[row] = vec4(0.0);
    rises[row] = vec4(0.0);
    first_rise[row] = 0.0;
    offsets[row] = 0.0;
    crossings[row] = vec4(NONE);
}

void copy_row(int row, int source) {
    texels[row] = texels[source];
    rises[row] = rises[source];
    first_rise[row] = first_rise[source];
    offsets[row] = offsets[source];
    crossings[row] = crossings[source];
}

void read_row(int row, Course course, int line, int first_row) {
    int at = line + drifted(course, first_row + row);
    int last = course.across - 1;
    float t0 = land_at(texel_of(course, first_row + row, clamp(at - 1, 0, last)));
    float t1 = land_at(texel_of(course, first_row + row, clamp(at, 0, last)));
    float t2 = land_at(texel_of(course, first_row + row, clamp(at + 1, 0, last)));
    float t3 = land_at(texel_of(course, first_row + row, clamp(at + 2, 0, last)));
    float t4 = land_at(texel_of(course, first_row + row, clamp(at + 3, 0, last)));
    float t5 = land_at(texel_of(course, first_row + row, clamp(at + 4, 0, last)));
    texels[row] = vec4(t1, t2, t3, t4);
    rises[row] = vec4(t2 - t1, t3 - t2, t4 - t3, t5 - t4);
    first_rise[row] = t1 - t0;
    offsets[row] = offset_of(course, first_row + row);
    // Lines beyond the edge count as far as a line of sight between them and it may run. As
    // unsigned numbers, those below 0 are large.
    bool on_row = first_row + row < course.rows;
    uvec4 across = uvec4(ivec4(at + 1, at + 2, at + 3, at + 4));
    bvec4 on_land = lessThan(across, uvec4(on_row ? course.across + 2 : 0));
    vec4 to_edge = vec4(ivec4(at, at + 1, at + 2, at + 3));
    to_edge = course.drift < 0 ? to_edge : float(last) - to_edge;
    float drift = course.drift < 0 ? -offsets[row] : offsets[row];
    bvec4 certain = greaterThanEqual(to_edge, vec4(drift));
    Crossing crossing = crossing_at(texels[row], vec4(first_rise[row], rises[row].xyz),
                                    rises[row], offsets[row]);
    crossings[row] = mix(vec4(NONE), mix(vec4(NONE), crossing.height, on_land), certain);
    vec4 highest = crossing.highest;
    highest = mix(highest, vec4(NONE), lessThanEqual(highest, crossings[row] + tolerance()));
    highest = mix(vec4(NONE), highest, on_land);
    highest_in_block = max(highest_in_block, highest);
    uncertain_rows |= ivec4(greaterThan(highest, vec4(NONE))) << row;
    // The edge that the lines drift to is half a texel beyond the last middle. The smallest part
    // of a drift more, so that rounding leaves on the terrain what is on its edge.
    rows_to_edge[row] = min(vec4(float(course.rows - 1 - first_row - row)),
                            (to_edge + 0.5 + 0.5 / 65536.0) * course.rows_a_texel);
}

// The texels of a row look at another row of the window, on their own lines of sight.
void look_at_row(int row, int other) {
    float run = float(other - row);
    float offset = offsets[other] - offsets[row];
    vec4 rise = offset > 0.0 ? rises[other] : vec4(first_rise[other], rises[other].xyz);
    vec4 slope = (texels[other] + offset * rise - texels[row]) * (1.0 / run);
    slope = mix(vec4(0.0), slope, lessThanEqual(vec4(run), rows_to_edge[row]));
    horizons[row] = max(horizons[row], floatBitsToInt(slope));
}

// The lowest bit of a word: its nearest row.
int nearest_in(int word) {
    return (floatBitsToInt(float(uint(word & -word))) >> 23) - 127;
}

Point point_on(Course course, int line, int row, int first_row) {
    int at = line + drifted(course, row);
    int last = course.across - 1;
    Point point;
    point.texel = land_at(texel_of(course, row, clamp(at, 0, last)));
    point.rise_after = land_at(texel_of(course, row, clamp(at + 1, 0, last))) - point.texel;
    point.rise_before = point.texel - land_at(texel_of(course, row, clamp(at - 1, 0, last)));
    point.offset = offset_of(course, row);
    point.crossing = crossing_at(vec4(point.texel), vec4(point.rise_before),
                                 vec4(point.rise_after), point.offset).height.x;
    point.distance = float(row - first_row);
    return point;
}

// The block's texels on a line look at a point: all of them, or those whose lines of sight are
// still on the terrain there.
void look_at_point(const int lane, Point point, const bool on_land_only) {
    for (int row = 0; row < BLOCK; row++) {
        float run = point.distance - float(row);
        float offset = point.offset - offsets[row];
        float rise = offset > 0.0 ? point.rise_after : point.rise_before;
        float slope = (point.texel + offset * rise - texels[row][lane]) / run;
        if (on_land_only && run > rows_to_edge[row][lane]) slope = 0.0;
        horizons[row][lane] = max(horizons[row][lane], floatBitsToInt(slope));
    }
}

// Whether rows of the block see more at the next point of the hull than at this one: those over
// the line through both. Also as long as the line itself is under it: on even slopes that is true
// for the texel too. The sign of a difference is set where a row is over the line.
bool sees_beyond(const int lane, float base, float slope) {
    int over = 0;
    for (int row = 0; row < BLOCK; row++) {
        float height = max(texels[row][lane], crossings[row][lane]);
        over |= floatBitsToInt(base + float(row) * slope - height);
    }
    return over < 0;
}

// Whether rows that will be on the hull cover this point: those over the line through both.
bool is_covered(const int lane, float base, float slope) {
    int over = 0;
    for (int row = 0; row < BLOCK; row++) {
        float height = crossings[NEAR + row][lane];
        over |= floatBitsToInt(base + float(NEAR + row) * slope - height);
    }
    return over < 0;
}

// The word of the hull or of the list that is under this one: its number, -1 for none.
int block_below(int word) {
    return (word >> 16) - 1;
}

// The block looks at a line's hull from its near end on, and drops points that it covers. `at` is
// where the line has its words in the buffer, `stride` from one word to the next. Returns the
// point on top.
Point look_at_hull(const int lane, Course course, int line, int first_row, int at, int stride,
                   inout Top top) {
    Top next_top = top;
    Point point = point_on(course, line, top.block * BLOCK + NEAR + nearest_in(top.word),
                           first_row);
    bool going = top.block >= 0;
    if (!going) {
        point.crossing = NONE;
        point.distance = 1e9;
    }
    Point highest = point;
    while (going) {
        look_at_point(lane, point, false);
        next_top.word &= next_top.word - 1;
        if ((next_top.word & 0xffff) == 0) {
            next_top.block = block_below(next_top.word);
            next_top.word = next_top.below;
            int below = block_below(next_top.below);
            if (next_top.block >= 0 && below >= 0) next_top.below = hull[at + below * stride];
        }
        bool more = next_top.block >= 0;
        Point next = point_on(course, line, next_top.block * BLOCK + NEAR
                              + nearest_in(next_top.word), first_row);
        float slope = more ? (next.crossing - point.crossing) / (next.distance - point.distance)
                : 0.0;
        float base = point.crossing - slope * point.distance;
        bool covered = is_covered(lane, base, slope);
        if (covered && more && highest.distance == point.distance) {
            top = next_top;
            highest = next;
        }
        going = more && (covered || sees_beyond(lane, base, slope));
        point = next;
    }
    return highest;
}

// The height on a row from which the block's texels on a line see it, or what is beyond it.
float lowest_visible(const int lane, int row_of_block) {
    float lowest = -NONE;
    for (int row = 0; row < BLOCK; row++) {
        float run = float(row_of_block - row);
        float slope = intBitsToFloat(horizons[row][lane]) + MIN_GAIN * error_a_row;
        bool on_land = run <= rows_to_edge[row][lane];
        lowest = min(lowest, on_land ? texels[row][lane] + slope * run : -NONE);
    }
    return lowest;
}

// The block looks at a line's uncertain rows, from a word of their list on.
void look_at_uncertain(const int lane, Course course, int line, int first_row, int at, int stride,
                       int block) {
    while (block >= 0) {
        int word = uncertain[at + block * stride];
        float lowest = lowest_visible(lane, block * BLOCK + nearest_in(word) - first_row);
        if (lowest >= highest_uncertain[lane]) break;
        bool visible = lowest < uncertain_height[at + block * stride];
        for (int rows = visible ? word & 0xffff : 0; rows != 0; rows &= rows - 1) {
            Point point = point_on(course, line, block * BLOCK + nearest_in(rows), first_row);
            look_at_point(lane, point, true);
        }
        block = block_below(word);
    }
}

// The rows at the far end of the window that are on the upper hull of these and of the hull's top.
int rows_on_hull(const int lane, Point top) {
    int word = 0;
    for (int row = 0; row < BLOCK; row++) {
        float height = crossings[NEAR + row][lane];
        float steepest = (top.crossing - height) / (top.distance - float(NEAR + row));
        float gentlest = -NONE;
        for (int other = 0; other < BLOCK; other++) {
            float slope = (crossings[NEAR + other][lane] - height) / float(other - row);
            if (other > row) steepest = max(steepest, slope);
            if (other < row) gentlest = min(gentlest, slope);
        }
        if (steepest < gentlest && height > 0.5 * NONE) word |= 1 << row;
    }
    return word;
}

void push_on_hull(int word, int block, int at, int stride, inout Top top) {
    if (word == 0) return;
    if (top.block >= 0) hull[at + top.block * stride] = top.word;
    top = Top(word | (top.block + 1) << 16, block, top.word);
}

// The newest block of a line with uncertain rows is the head of the list.
void push_uncertain(const int lane, int block, int at, int stride, inout int head) {
    highest_uncertain[lane] = max(highest_uncertain[lane], highest_in_block[lane]);
    if (uncertain_rows[lane] == 0) return;
    uncertain[at + block * stride] = uncertain_rows[lane] | (head + 1) << 16;
    uncertain_height[at + block * stride] = highest_in_block[lane];
    head = block;
}

void follow_line(const int lane, Course course, int line, int block, int at, int stride,
                 int far_uncertain, inout Top top) {
    int first_row = block * BLOCK;
    Point highest = look_at_hull(lane, course, line, first_row, at, stride, top);
    look_at_uncertain(lane, course, line, first_row, at, stride, far_uncertain);
    push_on_hull(rows_on_hull(lane, highest), block, at, stride, top);
}

// The block's tangents, of two rows each.
void store_tangents(int place, float metres_of_steep) {
    for (int row = 0; row < BLOCK; row += 2) {
        vec4 tangents = intBitsToFloat(horizons[row]) * metres_of_steep;
        vec4 next_tangents = intBitsToFloat(horizons[row + 1]) * metres_of_steep;
        uvec4 even = halves_of(min(tangents, MAX_TANGENT));
        uvec4 odd = halves_of(min(next_tangents, MAX_TANGENT));
        lines[place + row / 2] = uvec4(even.xz | even.yw << 16, odd.xz | odd.yw << 16);
    }
}

// The rows on which one of four lines is on the terrain, or less than a texel outside it.
ivec2 rows_on_terrain(Course course, int line) {
    float last = float(course.rows - 1);
    if (course.drift == 0) return ivec2(0, course.rows - 1);
    vec2 met = vec2(-line - 5, course.across + 1 - line) * (65536.0 / float(course.drift))
            + float(course.middle);
    return ivec2(clamp(vec2(floor(min(met.x, met.y)), ceil(max(met.x, met.y))), 0.0, last));
}

void move_window(Course course, int line, int first_row) {
    for (int row = WINDOW - 1; row >= BLOCK; row--) copy_row(row, row - BLOCK);
    uncertain_rows = ivec4(0);
    highest_in_block = vec4(NONE);
    for (int row = 0; row < BLOCK; row++) {
        read_row(row, course, line, first_row);
        horizons[row] = ivec4(0);
    }
}

void sweep_lines(Batch batch, int pair, int side) {
    int group = int(gl_GlobalInvocationID.x);
    vec2 towards = pair_towards(pair, batch.pairs, first);
    if (side == 1) towards = -towards;
    Course course = course_towards(towards, size, spacing_of(size, extent));
    int line = first_line(course) + 4 * group;
    int least_drift = min(drifted(course, 0), drifted(course, course.rows - 1));
    if (line + least_drift > course.across) return;
    int stride = size.x + size.y + 64;
    int at = int(gl_WorkGroupID.y) * ((max(size.x, size.y) + 31) >> 3) * stride + 4 * group;
    int place_of_side = batch.stride * (2 * (pair - batch.from) + side);
    float metres_of_steep = relief * course.steep;
    half_width = (course.drift & 0xffff) == 0 ? 0.0 : 0.5;
    error_a_row = MAX_ERROR / max(metres_of_steep, 1e-30);

    for (int row = 0; row < WINDOW; row++) clear_row(row);
    Top tops[4];
    int heads[4];
    for (int lane = 0; lane < 4; lane++) {
        tops[lane] = Top(0, -1, 0);
        heads[lane] = -1;
        highest_uncertain[lane] = NONE;
    }
    // The heads of the lists of uncertain rows one block and two ago: beyond the window.
    ivec4 near_uncertain = ivec4(-1);
    ivec4 far_uncertain = ivec4(-1);

    ivec2 rows = rows_on_terrain(course, line);
    for (int block = rows.y / BLOCK; block >= rows.x / BLOCK; block--) {
        move_window(course, line, block * BLOCK);
        for (int row = 0; row < BLOCK; row++) {
            for (int other = 0; other < WINDOW; other++) {
                if (other > row) look_at_row(row, other);
            }
        }
        // No loop: loops around loops are not unrolled.
        follow_line(0, course, line, block, at, stride, far_uncertain.x, tops[0]);
        follow_line(1, course, line + 1, block, at + 1, stride, far_uncertain.y, tops[1]);
        follow_line(2, course, line + 2, block, at + 2, stride, far_uncertain.z, tops[2]);
        follow_line(3, course, line + 3, block, at + 3, stride, far_uncertain.w, tops[3]);
        far_uncertain = near_uncertain;
        near_uncertain = ivec4(heads[0], heads[1], heads[2], heads[3]);
        for (int lane = 0; lane < 4; lane++) {
            push_uncertain(lane, block, at + lane, stride, heads[lane]);
        }
        store_tangents(place_of_side + place_of(course, group, block * BLOCK), metres_of_steep);
    }
}

void sweep(Batch batch) {
    int pair = batch.from + int(gl_WorkGroupID.y);
    if (pair >= batch.end) return;
    for (int side = 0; side < 2; side++) sweep_lines(batch, pair, side);
}
#endif
#endif
