// lighting/horizons/sweep.glsl -- sweeps along lines: on which row each texel sees its horizon.
//
//   gives    sweep; in a compute variant only
//   needs    lighting/horizons/lines.glsl; first, extent, the buffers of lighting/horizons.comp
//   units    texels and rows; heights without unit; slopes for rows 1 m apart and heights of 1
//   source   Timonen and Westerholm 2010, as lighting/horizons.comp
//   tested   tests/glsl/test_horizons.py, against brute force in float64 and against the march
//
// A line runs up to half a texel beside a texel. What it sees highest, and what the line on the
// texel's other side does, need not be as high to the texel; so only which row that is comes
// from the lines, and the texel looks at both rows itself.
//
// A thread has four lines beside each other, and goes in blocks of eight rows:
//   - sixteen rows ahead of each texel are looked at exactly, between texels as the march does it:
//     so near, a line that runs beside a texel would see other terrain;
//   - what is further on is looked at from the line, where it passes beside the texel: so a slope
//     to the side counts for nothing. First what the block reaches;
//   - then the hull is followed from its near end, for all rows at once, as long as the next point
//     shows more to one of them; points that rows of the block cover are dropped from it;
//   - then the block's own hull goes on top: a word with a bit for each row, and the number of
//     the block that was on top before it;
//   - then each texel looks at the row that its line found. Where its own line of sight has left
//     the terrain before that row, it marches.
// The hull lies sixteen rows further on than the block, so that no texel meets its near rows
// there.
#ifndef LIGHTING_HORIZONS_SWEEP
#define LIGHTING_HORIZONS_SWEEP
#ifdef COMPUTE_STAGE
#include "lighting/horizons/lines.glsl"

const int BLOCK = 8;            // rows of a block, and bits of a word of the hull
const int NEAR = 16;            // rows that are looked at exactly
const int ROWS = BLOCK + NEAR;
const float NONE = -1e30;       // a height that hides nothing
const float OFF = 1e9;          // a place that is on no terrain

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
vec4 along[ROWS];      // heights where the lines cross the row
vec4 upper[ROWS];      // how much higher the next texel of the row is
vec4 lower[ROWS];      // how much higher this one is than the texel before it
float beside[ROWS];    // how far the lines run beside the middle of their texels
float aside[ROWS];     // how far the first line's texel is from the middle of the row
vec4 found[BLOCK];     // the steepest of the near rows, for rows 1 m apart and heights of 1
vec4 found_at[BLOCK];  // how many rows away
vec4 far[BLOCK];       // the steepest of the others as the lines see them
vec4 far_at[BLOCK];    // on which row, counted from the block's first
vec4 steepest[BLOCK];  // of the rows that will go on the hull, the slopes to those after them
vec4 gentlest[BLOCK];  // and from those before them

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
    lower[row] = vec4(t1 - t0, upper[row].xyz);
    beside[row] = beside_of(course, first_row + row);
    aside[row] = on_row ? float(at) - 0.5 * float(last) : OFF;
    // Lines beside the terrain belong to it as far as a line of sight between them and it may run.
    // As unsigned numbers, those below 0 are large.
    uvec4 across = uvec4(ivec4(at + 1, at + 2, at + 3, at + 4));
    bvec4 on_land = lessThan(across, uvec4(on_row ? course.across + 2 : 0));
    vec4 crossed = here[row] + max(beside[row], 0.0) * upper[row]
            + min(beside[row], 0.0) * lower[row];
    along[row] = mix(vec4(NONE), crossed, on_land);
}

// A row's texels look at the d-th row from them, on their own lines of sight.
void look_near(int row, int d, float half_width) {
    float part = beside[row + d] - beside[row];
    vec4 there = here[row + d] + max(part, 0.0) * upper[row + d] + min(part, 0.0) * lower[row + d];
    vec4 slope = (there - here[row]) * (1.0 / float(d));
    bvec4 on_land = lessThanEqual(abs(vec4(0.0, 1.0, 2.0, 3.0) + (aside[row + d] + part)),
                                  vec4(half_width));
    slope = mix(vec4(NONE), slope, on_land);
    found_at[row] = mix(found_at[row], vec4(d), greaterThan(slope, found[row]));
    found[row] = max(found[row], slope);
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

#define BEYOND(row) here[row] = vec4(0.0); along[row] = vec4(NONE); upper[row] = vec4(0.0); \
    lower[row] = vec4(0.0); beside[row] = 0.0; aside[row] = OFF;
#define TO_NEXT_BLOCK(row) here[row] = here[row - BLOCK]; along[row] = along[row - BLOCK]; \
    upper[row] = upper[row - BLOCK]; lower[row] = lower[row - BLOCK]; \
    beside[row] = beside[row - BLOCK]; aside[row] = aside[row - BLOCK];
#define ENTER(row) enter_row(row, course, line, first_row);
#define CLEAR(row) found[row] = vec4(0.0); found_at[row] = vec4(0.0); far[row] = vec4(0.0); \
    far_at[row] = vec4(0.0);
#define CLEAR_HULL(row) steepest[row] = vec4(NONE); gentlest[row] = vec4(-NONE);
#define LOOK_NEAR_1(row, d) look_near(row, d, half_width);
#define LOOK_NEAR(row) UP_TO_7_FROM(LOOK_NEAR_1, row) LOOK_NEAR_1(row, 8) LOOK_NEAR_1(row, 9) \
    LOOK_NEAR_1(row, 10) LOOK_NEAR_1(row, 11) LOOK_NEAR_1(row, 12) LOOK_NEAR_1(row, 13) \
    LOOK_NEAR_1(row, 14) LOOK_NEAR_1(row, 15) LOOK_NEAR_1(row, 16)
#define LOOK_ALONG(row, d) { \
    vec4 slope = (along[row + d] - along[row]) * (1.0 / float(d)); \
    far_at[row] = mix(far_at[row], vec4(row + d), greaterThan(slope, far[row])); \
    far[row] = max(far[row], slope); }
#define COMPARE(row, d) { \
    vec4 slope = (along[row + d] - along[row]) * (1.0 / float(d)); \
    steepest[row - NEAR] = max(steepest[row - NEAR], slope); \
    gentlest[row + d - NEAR] = min(gentlest[row + d - NEAR], slope); }
#define TAKE(row) now[row] = along[row][which];
#define SEE(row) seen[row] = far[row][which]; seen_at[row] = far_at[row][which];
#define GIVE(row) { \
    bvec4 chosen = equal(ivec4(which), ivec4(0, 1, 2, 3)); \
    far[row] = mix(far[row], vec4(seen[row]), chosen); \
    far_at[row] = mix(far_at[row], vec4(seen_at[row]), chosen); }
#define SEE_IF_STEEPER(row, slope) seen_at[row] = slope > seen[row] ? away : seen_at[row]; \
    seen[row] = max(seen[row], slope);
#define LOOK_FAR(row) { \
    vec4 part = reciprocals(away - vec4(row, row + 1, row + 2, row + 3)); \
    SEE_IF_STEEPER(row, (tall - now[row]) * part.x) \
    SEE_IF_STEEPER(row + 1, (tall - now[row + 1]) * part.y) \
    SEE_IF_STEEPER(row + 2, (tall - now[row + 2]) * part.z) \
    SEE_IF_STEEPER(row + 3, (tall - now[row + 3]) * part.w) }
#define LOOKS_ON(row) highest_near = max(highest_near, now[row] - slope * float(row));
#define COVER(row) highest = max(highest, now[row] - slope * float(row));
#define ON_HULL(row) if (max(steepest[row - NEAR][which], \
    (top_tall - now[row]) / (top_away - float(row))) < gentlest[row \
    - NEAR][which] && now[row] > 0.5 * NONE) word |= 1 << (row - NEAR);
#define CHOOSE(row) choose(row, course, line, first_row);
// What is ahead comes first, what is behind is added.
#define PUT(lines) lines[at] = back ? lines[at] | four << 16 : four
#define LEAVE(row) if (first_row + row < course.rows) { \
    uvec4 four = uvec4(chosen[row]); \
    int at = place + (back ? -row : row); \
    if ((pair & 1) == 0) PUT(even_lines); else PUT(odd_lines); }

ivec4 chosen[BLOCK];  // where each texel sees its horizon, as own_row and far_row read it
// a bit for each texel whose line looked where its own line of sight has left the terrain
int lost;

// Of a row's texels: the steepest of the near rows, or the one that the line found, if it is
// steeper to the texel.
void choose(int row, Course course, int line, int first_row) {
    ivec4 away = ivec4(far_at[row]) - row;
    int across = line + drifted(course, first_row + row);
    vec4 place = vec4(ivec4(across, across + 1, across + 2, across + 3))
            + vec4(away) * (float(course.drift) * (1.0 / 65536.0));
    vec4 held = clamp(place, 0.0, float(course.across - 1));
    ivec4 low = ivec4(held);
    ivec4 high = min(low + 1, course.across - 1);
    ivec4 there = min(first_row + row + away, course.rows - 1);
    vec4 from = vec4(land_at(texel_of(course, there.x, low.x)),
                     land_at(texel_of(course, there.y, low.y)),
                     land_at(texel_of(course, there.z, low.z)),
                     land_at(texel_of(course, there.w, low.w)));
    vec4 to = vec4(land_at(texel_of(course, there.x, high.x)),
                   land_at(texel_of(course, there.y, high.y)),
                   land_at(texel_of(course, there.z, high.z)),
                   land_at(texel_of(course, there.w, high.w)));
    vec4 slope = (from + (to - from) * (held - vec4(low)) - here[row]) / vec4(max(away, 1));
    ivec4 saw = ivec4(greaterThan(far[row], vec4(0.0)));
    ivec4 left = saw * ivec4(greaterThan(abs(place - 0.5 * float(course.across - 1)),
                                         vec4(0.5 * float(course.across))));
    ivec4 steeper = (saw - left) * ivec4(greaterThan(slope, found[row]));
    ivec4 near = ivec4(found_at[row]);
    // What is left of a far row, if a near one is steeper: as much of its number as has room.
    ivec4 rest = saw * ((floatBitsToInt(vec4(max(away, 1))) >> 16) - SEVEN_BITS);
    ivec4 both = NEAR_WINS + (near - 1) * MOST_REST + rest;
    ivec4 alone = ivec4(bvec4(ivec4(equal(near, ivec4(0))) + steeper + left));
    chosen[row] = both + alone * (saw * away - both);
    // Only texels of the terrain count.
    left *= ivec4(lessThan(uvec4(ivec4(across, across + 1, across + 2, across + 3)),
                           uvec4(first_row + row < course.rows ? course.across : 0)));
    lost |= (left.x | left.y << 1 | left.z << 2 | left.w << 3) << (4 * row);
}

// Those march, one after the other.
void march_lost(Course course, int line, int first_row) {
    int d = 1;
    int best = 0;
    float steepest_yet = 0.0;
    while (lost != 0) {
        int bit = nearest_in(lost);
        int row = first_row + (bit >> 2);
        int across = line + drifted(course, row) + (bit & 3);
        float tangent = tangent_at(course, row, across, d, land_at(texel_of(course, row, across)));
        bool on_land = sees(course, row, across, d);
        best = on_land && tangent > steepest_yet ? d : best;
        steepest_yet = on_land ? max(steepest_yet, tangent) : 0.0;
        if (!on_land) {
            chosen[bit >> 2][bit & 3] = best;
            lost &= lost - 1;
            best = 0;
        }
        d = on_land ? d + 1 : 1;
    }
}

// The height where a line crosses a row.
float height_on(Course course, int row, int line) {
    int at = line + drifted(course, row);
    float part = beside_of(course, row);
    float texel = land_at(texel_of(course, row, clamp(at, 0, course.across - 1)));
    float other = land_at(texel_of(course, row,
                                   clamp(part < 0.0 ? at - 1 : at + 1, 0, course.across - 1)));
    return texel + abs(part) * (other - texel);
}

// One of the four lines looks at the hull, and puts the block's rows on it.
void follow_hull(int which, int block, Course course, int line, int hull_at, int apart,
                 inout ivec4 top_word, inout ivec4 top_block) {
    float now[ROWS];
    float seen[BLOCK];
    float seen_at[BLOCK];
    UP_TO_24(TAKE)
    UP_TO_8(SEE)
    int word = top_word[which];
    int in_block = top_block[which];
    bool going = in_block >= 0;
    int first_row = block * BLOCK;
    int row = in_block * BLOCK + NEAR + nearest_in(word);
    // The point that is looked at, and the topmost that stays on the hull: height, rows away.
    float tall = going ? height_on(course, row, line + which) : NONE;
    float away = going ? float(row - first_row) : 1e9;
    float top_tall = tall;
    float top_away = away;
    int rest = word;
    int rest_in = in_block;
    while (going) {
        LOOK_FAR(0) LOOK_FAR(4)
        // The next point.
        rest &= rest - 1;
        if ((rest & 0xffff) == 0) {
            rest_in = (rest >> 16) - 1;
            if (rest_in >= 0) rest = hull[hull_at + which + rest_in * apart];
        }
        bool more = rest_in >= 0;
        row = rest_in * BLOCK + NEAR + nearest_in(rest);
        float next_tall = height_on(course, row, line + which);
        float next_away = float(row - first_row);
        // A row over the line through both sees more at the next; a row that will be on
        // the hull and is there covers this point.
        float slope = more ? (next_tall - tall) / (next_away - away) : 0.0;
        float base = tall - slope * away;
        float highest = NONE;
        float highest_near = NONE;
        UP_TO_8(LOOKS_ON)
        FROM_16(COVER)
        if (highest > base && more && top_away == away) {
            word = rest;
            in_block = rest_in;
            top_tall = next_tall;
            top_away = next_away;
        }
        going = max(highest, highest_near) > base && more;
        tall = next_tall;
        away = next_away;
    }
    int below = word;
    word = 0;
    FROM_16(ON_HULL)
    bool grows = word != 0;
    if (grows && in_block >= 0) hull[hull_at + which + in_block * apart] = below;
    top_word[which] = grows ? word | ((in_block + 1) << 16) : below;
    top_block[which] = grows ? block : in_block;
    UP_TO_8(GIVE)
}

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
        float half_width = 0.5 * float(course.across);
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
        UP_TO_24(BEYOND)
        for (int block = off ? -1 : int(ends.y) / BLOCK; block >= int(ends.x) / BLOCK; block--) {
            int first_row = block * BLOCK;
            FROM_16(TO_NEXT_BLOCK)
            FROM_8(TO_NEXT_BLOCK)
            UP_TO_8(ENTER)
            UP_TO_8(CLEAR)
            UP_TO_8(CLEAR_HULL)
            UP_TO_8(LOOK_NEAR)
            FAR_PAIRS(LOOK_ALONG)
            HULL_PAIRS(COMPARE)
            for (int which = 0; which < 4; which++) {
                follow_hull(which, block, course, line, hull_at, apart, top_word, top_block);
            }
            int place = batch.apart * ((pair - batch.from) >> 1)
                    + place_of(course, group, back ? course.rows - 1 - first_row : first_row);
            lost = 0;
            UP_TO_8(CHOOSE)
            march_lost(course, line, first_row);
            UP_TO_8(LEAVE)
        }
    }
}
#endif
#endif
