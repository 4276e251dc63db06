// lighting/horizons/sweep.glsl -- sweeps along lines: how steep each texel sees its horizon.
//
//   gives    sweep; in a compute variant only
//   needs    lighting/horizons/lines.glsl; first, extent, relief, the buffers of
//            lighting/horizons.comp
//   units    texels and rows; heights without unit; slopes for rows 1 m apart and heights of 1
//   source   Timonen and Westerholm 2010, as lighting/horizons.comp
//   tested   tests/glsl/test_horizons.py, against brute force in float64 and against the march
//
// A line runs up to half a texel beside a texel. What it sees highest need not be as high to the
// texel; so only which rows are looked at comes from the lines, and each of these rows the texel
// looks at itself, on its own line of sight, between texels as the march does it.
//
// A thread has four lines beside each other, and goes in blocks of eight rows:
//   - the block's rows look at the sixteen rows ahead of each, and at what is left of the next two
//     blocks: so near, a line that runs beside a texel would see other terrain;
//   - then the hull is followed from its near end, for all rows at once, as long as the next point
//     shows more to one of them, and all rows look at each point on the way; points that rows of
//     the block cover are dropped from it;
//   - then the uncertain rows are looked at one by one, where they are high enough to be seen: no
//     single height on the line is true for all lines of sight along it;
//   - then the block's own hull goes on top: a word with a bit for each row, and the number of
//     the block that was on top before it.
// The hull lies sixteen rows further on than the block, so that no texel meets its near rows
// there. The list of uncertain rows is made of words like the hull's, and begins as far away.
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
#ifndef LIGHTING_HORIZONS_SWEEP
#define LIGHTING_HORIZONS_SWEEP
#ifdef COMPUTE_STAGE
#include "lighting/horizons/lines.glsl"

const int BLOCK = 8;            // rows of a block, and bits of a word of the hull
const int NEAR = 16;            // rows that are looked at exactly
const int ROWS = BLOCK + NEAR;
const float NONE = -1e30;       // a height that hides nothing
const float MAX_ERROR = 0.05;   // of a horizon's tangent, on any terrain
const float MIN_GAIN = 0.1;     // of that error, for which an uncertain row is looked at

// Each of several rows, or pairs of rows, written out as in lighting/horizons/lines.glsl.
#define FROM_8(DO) DO(8) DO(9) DO(10) DO(11) DO(12) DO(13) DO(14) DO(15)
#define FROM_16(DO) DO(16) DO(17) DO(18) DO(19) DO(20) DO(21) DO(22) DO(23)
#define UP_TO_24(DO) UP_TO_8(DO) FROM_8(DO) FROM_16(DO)
#define UP_TO_7_FROM(DO, row) DO(row, 1) DO(row, 2) DO(row, 3) DO(row, 4) DO(row, 5) DO(row, 6) \
    DO(row, 7)
// The pairs of rows that are further apart than NEAR, and those of the last eight rows.
#define FAR_PAIRS(DO) DO(0, 17) DO(0, 18) DO(0, 19) DO(0, 20) DO(0, 21) DO(0, 22) DO(0, 23) \
    DO(1, 17) DO(1, 18) DO(1, 19) DO(1, 20) DO(1, 21) DO(1, 22) DO(2, 17) DO(2, 18) DO(2, 19) \
    DO(2, 20) DO(2, 21) DO(3, 17) DO(3, 18) DO(3, 19) DO(3, 20) DO(4, 17) DO(4, 18) DO(4, 19) \
    DO(5, 17) DO(5, 18) DO(6, 17)
#define HULL_PAIRS(DO) UP_TO_7_FROM(DO, 16) DO(17, 1) DO(17, 2) DO(17, 3) DO(17, 4) DO(17, 5) \
    DO(17, 6) DO(18, 1) DO(18, 2) DO(18, 3) DO(18, 4) DO(18, 5) DO(19, 1) DO(19, 2) DO(19, 3) \
    DO(19, 4) DO(20, 1) DO(20, 2) DO(20, 3) DO(21, 1) DO(21, 2) DO(22, 1)

// A block's rows and after them the nearest rows of the blocks before, on four lines. A texel
// beside the terrain is as high as the terrain's edge.
vec4 here[ROWS];       // heights of the texels
vec4 along[ROWS];      // c, the lines' heights on the row
vec4 upper[ROWS];      // how much higher the next texel of the row is
float lower[ROWS];     // how much higher the first of these texels is than the one before it
float beside[ROWS];    // how far the lines run beside the middle of their texels
vec4 leaves[BLOCK];    // after how many rows the texels' own lines of sight leave the terrain
// The steepest slope that the texels see, 0 or more, for rows 1 m apart and heights of 1: as bits,
// whose maximum is one instruction, where that of floats looks for numbers that are none.
ivec4 found[BLOCK];
vec4 steepest[BLOCK];  // of the rows that will go on the hull, the slopes to those after them
vec4 gentlest[BLOCK];  // and from those before them
ivec4 uncertain_rows;    // a bit for each uncertain row of the block
vec4 highest_in_block;   // U of the highest of these
vec4 highest_uncertain;  // and of the highest so far
float error_a_row;       // MAX_ERROR as a height on the next row
float half_width;        // how far lines of sight run from the line that they are along

// The heights of a row at so many texels beside the middles of these, -1 to 1.
vec4 beside_texels(int row, float part) {
    vec4 sideways = mix(vec4(lower[row], upper[row].xyz), upper[row], bvec4(part > 0.0));
    return here[row] + part * sideways;
}

// c, L and U of a row: the heights of lines beside texels, and the extremes around them.
struct Crossing {
    vec4 height;
    vec4 lowest;
    vec4 highest;
};

// A tolerance in which a line's height is as good as that of each line of sight along it.
float tolerance() {
    return 0.5 * float(NEAR + 1) * error_a_row;
}

// From the heights of the texels nearest to the lines, the rises to these from the texels before
// and from these to the next, and how far beside them the lines run.
Crossing crossing_at(vec4 texel, vec4 lower_rise, vec4 upper_rise, float part) {
    vec4 left = texel + min(part - half_width, 0.0) * lower_rise;
    vec4 right = texel + max(part + half_width, 0.0) * upper_rise;
    Crossing crossing;
    crossing.lowest = min(texel, min(left, right));
    crossing.highest = max(texel, max(left, right));
    crossing.height = min(texel + part * (part > 0.0 ? upper_rise : lower_rise),
                          crossing.lowest + tolerance());
    return crossing;
}

void enter_row(int row, Course course, int line, int first_row) {
    int at = line + drifted(course, first_row + row);
    int last = course.across - 1;
    float t0 = land_at(texel_of(course, first_row + row, clamp(at - 1, 0, last)));
    float t1 = land_at(texel_of(course, first_row + row, clamp(at, 0, last)));
    float t2 = land_at(texel_of(course, first_row + row, clamp(at + 1, 0, last)));
    float t3 = land_at(texel_of(course, first_row + row, clamp(at + 2, 0, last)));
    float t4 = land_at(texel_of(course, first_row + row, clamp(at + 3, 0, last)));
    float t5 = land_at(texel_of(course, first_row + row, clamp(at + 4, 0, last)));
    bool on_row = first_row + row < course.rows;
    here[row] = vec4(t1, t2, t3, t4);
    upper[row] = vec4(t2 - t1, t3 - t2, t4 - t3, t5 - t4);
    lower[row] = t1 - t0;
    beside[row] = beside_of(course, first_row + row);
    // Lines beside the terrain belong to it as far as a line of sight between them and it may run.
    // As unsigned numbers, those below 0 are large.
    uvec4 across = uvec4(ivec4(at + 1, at + 2, at + 3, at + 4));
    bvec4 on_land = lessThan(across, uvec4(on_row ? course.across + 2 : 0));
    vec4 to_edge = vec4(ivec4(at, at + 1, at + 2, at + 3));
    to_edge = course.drift < 0 ? to_edge : float(last) - to_edge;
    bvec4 sure = greaterThanEqual(to_edge, vec4(course.drift < 0 ? -beside[row] : beside[row]));
    Crossing crossing = crossing_at(here[row], vec4(lower[row], upper[row].xyz), upper[row],
                                    beside[row]);
    along[row] = mix(vec4(NONE), mix(vec4(NONE), crossing.height, on_land), sure);
    vec4 highest = crossing.highest;
    highest = mix(highest, vec4(NONE), lessThanEqual(highest, along[row] + tolerance()));
    highest = mix(vec4(NONE), highest, on_land);
    highest_in_block = max(highest_in_block, highest);
    uncertain_rows |= ivec4(greaterThan(highest, vec4(NONE))) << row;
    // To the side: the edge that the lines drift to is half a texel beyond the last middle. The
    // smallest part of a drift more, so that rounding leaves on the terrain what is on its edge.
    leaves[row] = min(vec4(float(course.rows - 1 - first_row - row)),
                      (to_edge + 0.5 + 0.5 / 65536.0) * course.rows_a_texel);
}

// A row's texels look at the d-th row from them, on their own lines of sight.
void look_near(int row, int d) {
    vec4 there = beside_texels(row + d, beside[row + d] - beside[row]);
    vec4 slope = (there - here[row]) * (1.0 / float(d));
    bvec4 on_land = lessThanEqual(vec4(d), leaves[row]);
    ivec4 most = max(found[row], floatBitsToInt(slope));
    found[row] = ivec4(on_land.x ? most.x : found[row].x, on_land.y ? most.y : found[row].y,
                       on_land.z ? most.z : found[row].z, on_land.w ? most.w : found[row].w);
}

// 1/x, with one division for four.
vec4 reciprocals(vec4 x) {
    float left = x.x * x.y;
    float right = x.z * x.w;
    vec2 halves = vec2(right, left) * (1.0 / (left * right));
    return vec4(halves.x * x.y, halves.x * x.x, halves.y * x.w, halves.y * x.z);
}

// The lowest bit of a word: its nearest row.
int nearest_in(int word) {
    return (floatBitsToInt(float(uint(word & -word))) >> 23) - 127;
}

// A point of a line's hull: the heights around it, and where it is.
struct Point {
    float texel;    // the height of the texel that the line is nearest to
    float upper;    // how much higher the next texel of the row is
    float lower;    // how much higher this one is than the texel before it
    float beside;   // how far the line runs beside the middle of that texel
    float crossed;  // c, the line's height on the row
    float away;     // on which row, counted from the block's first
};

Point point_on(Course course, int line, int row, int first_row) {
    int at = line + drifted(course, row);
    int last = course.across - 1;
    Point point;
    point.texel = land_at(texel_of(course, row, clamp(at, 0, last)));
    point.upper = land_at(texel_of(course, row, clamp(at + 1, 0, last))) - point.texel;
    point.lower = point.texel - land_at(texel_of(course, row, clamp(at - 1, 0, last)));
    point.beside = beside_of(course, row);
    point.crossed = crossing_at(vec4(point.texel), vec4(point.lower), vec4(point.upper),
                                point.beside).height.x;
    point.away = float(row - first_row);
    return point;
}

#define BEYOND(row) here[row] = vec4(0.0); along[row] = vec4(NONE); upper[row] = vec4(0.0); \
    lower[row] = 0.0; beside[row] = 0.0;
#define TO_NEXT_BLOCK(row) here[row] = here[row - BLOCK]; along[row] = along[row - BLOCK]; \
    upper[row] = upper[row - BLOCK]; lower[row] = lower[row - BLOCK]; \
    beside[row] = beside[row - BLOCK];
#define ENTER(row) enter_row(row, course, line, first_row);
#define CLEAR(row) found[row] = ivec4(0);
#define CLEAR_HULL(row) steepest[row] = vec4(NONE); gentlest[row] = vec4(-NONE);
#define LOOK_NEAR_1(row, d) look_near(row, d);
#define LOOK_NEAR(row) UP_TO_7_FROM(LOOK_NEAR_1, row) LOOK_NEAR_1(row, 8) LOOK_NEAR_1(row, 9) \
    LOOK_NEAR_1(row, 10) LOOK_NEAR_1(row, 11) LOOK_NEAR_1(row, 12) LOOK_NEAR_1(row, 13) \
    LOOK_NEAR_1(row, 14) LOOK_NEAR_1(row, 15) LOOK_NEAR_1(row, 16)
#define COMPARE(row, d) { \
    vec4 slope = (along[row + d] - along[row]) * (1.0 / float(d)); \
    steepest[row - NEAR] = max(steepest[row - NEAR], slope); \
    gentlest[row + d - NEAR] = min(gentlest[row + d - NEAR], slope); }
// All that look along a line see its hull; an uncertain row, those whose lines of sight are still
// on the terrain.
#define SLOPE_TO_POINT(row, part) \
    float aside = point.beside - beside[row]; \
    float there = point.texel + aside * (aside > 0.0 ? point.upper : point.lower); \
    float slope = (there - here[row][which]) * part;
#define SEE(row, part) { \
    SLOPE_TO_POINT(row, part) \
    found[row][which] = max(found[row][which], floatBitsToInt(slope)); }
#define SEE_IF_ON_LAND(row, part) { \
    SLOPE_TO_POINT(row, part) \
    bool on_land = point.away - float(row) <= leaves[row][which]; \
    found[row][which] = max(found[row][which], floatBitsToInt(on_land ? slope : 0.0)); }
#define LOOK_FAR(row, SEE_1) { \
    vec4 part = reciprocals(point.away - vec4(row, row + 1, row + 2, row + 3)); \
    SEE_1(row, part.x) SEE_1(row + 1, part.y) SEE_1(row + 2, part.z) SEE_1(row + 3, part.w) }
// Also as long as it shows more from the line: on even slopes that is true for the texel too.
#define LOOKS_ON(row) \
    over_near |= floatBitsToInt(base - max(here[row][which], along[row][which])); \
    base += slope;
#define COVER(row) over |= floatBitsToInt(base - along[row][which]); base += slope;
// What is lower than that, on that row or further on, a texel need not look at.
#define SEES_OVER(nth) { \
    float away = float(row - first_row - nth); \
    float least = here[nth][which] \
        + (intBitsToFloat(found[nth][which]) + MIN_GAIN * error_a_row) * away; \
    lowest = min(lowest, away <= leaves[nth][which] ? least : -NONE); }
#define ON_HULL(row) if (max(steepest[row - NEAR][which], \
    (top_tall - along[row][which]) / (top_away - float(row))) < gentlest[row \
    - NEAR][which] && along[row][which] > 0.5 * NONE) word |= 1 << (row - NEAR);
// The tangents of two rows.
#define LEAVE(row) { \
    uvec4 one = halves_of(min(intBitsToFloat(found[row]) * metres_of_steep, HIGHEST)); \
    uvec4 next = halves_of(min(intBitsToFloat(found[row + 1]) * metres_of_steep, HIGHEST)); \
    lines[place + row / 2] = uvec4(one.xz | one.yw << 16, next.xz | next.yw << 16); }

// One of the four lines looks at the hull, and puts the block's rows on it.
void follow_hull(const int which, int block, Course course, int line, int hull_at, int apart,
                 int uncertain_block, inout ivec4 top_word, inout ivec4 top_block,
                 inout ivec4 second_word) {
    int word = top_word[which];
    int in_block = top_block[which];
    bool going = in_block >= 0;
    int first_row = block * BLOCK;
    int row = in_block * BLOCK + NEAR + nearest_in(word);
    Point point = point_on(course, line + which, row, first_row);
    point.crossed = going ? point.crossed : NONE;
    point.away = going ? point.away : 1e9;
    // The topmost that stays on the hull.
    float top_tall = point.crossed;
    float top_away = point.away;
    int rest = word;
    int rest_in = in_block;
    // The word below is at hand: what is read from a buffer takes longer than what a point costs.
    int under = second_word[which];
    int second = under;
    while (going) {
        LOOK_FAR(0, SEE) LOOK_FAR(4, SEE)
        // The next point.
        rest &= rest - 1;
        if ((rest & 0xffff) == 0) {
            rest_in = (rest >> 16) - 1;
            rest = under;
            int under_in = (under >> 16) - 1;
            if (rest_in >= 0 && under_in >= 0) under = hull[hull_at + which + under_in * apart];
        }
        bool more = rest_in >= 0;
        row = rest_in * BLOCK + NEAR + nearest_in(rest);
        Point next = point_on(course, line + which, row, first_row);
        // A texel over the line through both sees more at the next; a row that will be on
        // the hull and is there covers this point.
        float slope = more ? (next.crossed - point.crossed) / (next.away - point.away) : 0.0;
        float base = point.crossed - slope * point.away;
        // Signs: that of a row which is over it is set.
        int over = 0;
        int over_near = 0;
        UP_TO_8(LOOKS_ON)
        base += 8.0 * slope;
        FROM_16(COVER)
        if (over < 0 && more && top_away == point.away) {
            word = rest;
            in_block = rest_in;
            second = under;
            top_tall = next.crossed;
            top_away = next.away;
        }
        going = (over | over_near) < 0 && more;
        point = next;
    }
    while (uncertain_block >= 0) {
        int rows = uncertain[hull_at + which + uncertain_block * apart];
        row = uncertain_block * BLOCK + nearest_in(rows);
        float lowest = -NONE;
        UP_TO_8(SEES_OVER)
        if (lowest >= highest_uncertain[which]) break;
        bool visible = lowest < uncertain_height[hull_at + which + uncertain_block * apart];
        for (int left = visible ? rows & 0xffff : 0; left != 0; left &= left - 1) {
            row = uncertain_block * BLOCK + nearest_in(left);
            point = point_on(course, line + which, row, first_row);
            LOOK_FAR(0, SEE_IF_ON_LAND) LOOK_FAR(4, SEE_IF_ON_LAND)
        }
        uncertain_block = (rows >> 16) - 1;
    }
    int below = word;
    word = 0;
    FROM_16(ON_HULL)
    bool grows = word != 0;
    if (grows && in_block >= 0) hull[hull_at + which + in_block * apart] = below;
    top_word[which] = grows ? word | ((in_block + 1) << 16) : below;
    top_block[which] = grows ? block : in_block;
    second_word[which] = grows ? below : second;
}

#define FOLLOW(which) follow_hull(which, block, course, line, hull_at, apart, \
    far_uncertain[which], top_word, top_block, second_word);
// The newest block of a line with uncertain rows is the head of the list.
#define LINK(which) if (uncertain_rows[which] != 0) { \
    uncertain[hull_at + which + block * apart] = \
        uncertain_rows[which] | (uncertain_block[which] + 1) << 16; \
    uncertain_height[hull_at + which + block * apart] = highest_in_block[which]; \
    uncertain_block[which] = block; }

void sweep(Batch batch) {
    int pair = batch.from + int(gl_WorkGroupID.y);
    int group = int(gl_GlobalInvocationID.x);
    vec2 towards = pair_towards(pair, batch.pairs, first);
    int apart = size.x + size.y + 64;
    int hull_at = int(gl_WorkGroupID.y) * ((max(size.x, size.y) + 31) >> 3) * apart + 4 * group;
    for (int side = 0; side < 2; side++) {
        bool back = side == 1;
        Course course = course_towards(back ? -towards : towards, size, spacing_of(size, extent));
        int line = first_line(course) + 4 * group;
        int drift_away = min(drifted(course, 0), drifted(course, course.rows - 1));
        bool off = pair >= batch.end || line + drift_away > course.across;
        float metres_of_steep = relief * course.steep;
        // The rows on which one of the four lines is on the terrain, or less than a texel beside
        // it.
        vec2 ends = vec2(0.0, float(course.rows - 1));
        if (course.drift != 0) {
            vec2 met = vec2(-line - 5, course.across + 1 - line) * (65536.0 / float(course.drift))
                    + float(course.middle);
            ends = clamp(vec2(floor(min(met.x, met.y)), ceil(max(met.x, met.y))), 0.0, ends.y);
        }
        ivec4 top_word = ivec4(0);
        ivec4 top_block = ivec4(-1);
        ivec4 second_word = ivec4(0);
        // The heads of the lists of uncertain rows, from the next block on, from the second, and
        // from the third: that which the block looks at.
        ivec4 uncertain_block = ivec4(-1);
        ivec4 second_uncertain = ivec4(-1);
        ivec4 far_uncertain = ivec4(-1);
        highest_uncertain = vec4(NONE);
        half_width = (course.drift & 0xffff) == 0 ? 0.0 : 0.5;
        error_a_row = MAX_ERROR / max(metres_of_steep, 1e-30);
        UP_TO_24(BEYOND)
        for (int block = off ? -1 : int(ends.y) / BLOCK; block >= int(ends.x) / BLOCK; block--) {
            int first_row = block * BLOCK;
            FROM_16(TO_NEXT_BLOCK)
            FROM_8(TO_NEXT_BLOCK)
            uncertain_rows = ivec4(0);
            highest_in_block = vec4(NONE);
            UP_TO_8(ENTER)
            UP_TO_8(CLEAR)
            UP_TO_8(CLEAR_HULL)
            UP_TO_8(LOOK_NEAR)
            FAR_PAIRS(LOOK_NEAR_1)
            HULL_PAIRS(COMPARE)
            UP_TO_4(FOLLOW)
            highest_uncertain = max(highest_uncertain, highest_in_block);
            far_uncertain = second_uncertain;
            second_uncertain = uncertain_block;
            UP_TO_4(LINK)
            int place = batch.apart * (2 * (pair - batch.from) + side)
                    + place_of(course, group, first_row);
            LEAVE(0) LEAVE(2) LEAVE(4) LEAVE(6)
        }
    }
}
#endif
#endif
