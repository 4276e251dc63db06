// lighting/horizons/sum.glsl -- sums of the sky over the horizons that sweeps have found.
//
//   gives    sum; in a compute variant only
//   needs    lighting/horizons/lines.glsl, lighting/horizons/open_sky.glsl,
//            lighting/horizons/slope.glsl; the parameters, buffers and outputs of
//            lighting/horizons.comp
//   units    tangents: rise over run; shares of the sky's light
//   source   Timonen and Westerholm 2010, as lighting/horizons.comp
//   tested   tests/glsl/test_horizons.py, against brute force in float64 and against the march
//
// A sweep has left in lines on which rows a texel sees its horizons; from each texel a sum looks
// at these, takes the steeper, and adds what sky they leave.
#ifndef LIGHTING_HORIZONS_SUM
#define LIGHTING_HORIZONS_SUM
#ifdef COMPUTE_STAGE
#include "lighting/horizons/lines.glsl"
#include "lighting/horizons/open_sky.glsl"
#include "lighting/horizons/slope.glsl"
#include "maths/land.glsl"

const float HIGHEST = 60000.0;  // a tangent that a half float holds

// The courses of a batch's pairs, kept by each thread: directions, and drift, axis, sense, first
// line.
vec2 ways[8];
ivec4 courses[8];
float steeps[8];

Course course_of(int number) {
    ivec4 kept = courses[number];
    Course course;
    course.drift = kept.x;
    course.along_x = kept.y == 1;
    course.upwards = kept.z == 1;
    course.rows = course.along_x ? size.x : size.y;
    course.across = course.along_x ? size.y : size.x;
    course.middle = course.upwards ? (course.rows - 1) >> 1 : course.rows >> 1;
    course.steep = steeps[number];
    return course;
}

// The opposite course.
Course turned(Course course) {
    course.upwards = !course.upwards;
    course.drift = -course.drift;
    course.middle = course.rows - 1 - course.middle;
    return course;
}

// A texel's horizon: the steeper of the rows that its own line and the one on its other side
// found.
float tangent_of(Course course, int row, int across, int own, int other, float foot) {
    float tangent = tangent_at(course, row, across, own, foot);
    float beyond = tangent_at(course, row, across, other, foot);
    return max(max(tangent, sees(course, row, across, other) ? beyond : 0.0), 0.0);
}

#define BEGIN(nth) { \
    ivec2 texel = ivec2(x, min(y + nth, size.y - 1)); \
    slope[nth] = slope_here(texel, size, metres, relief, normal); \
    foot[nth] = land_at(texel); \
    total[nth] = batch.from > 0 ? sky[texel.y * size.x + texel.x] : 0.0; \
    ahead[nth] = keep && batch.from > 0 ? imageLoad(out_ahead, texel) : vec4(0.0); \
    behind[nth] = keep && batch.from > 0 ? imageLoad(out_behind, texel) : vec4(0.0); }
#define ADD(nth, lines) { \
    int along = course.along_x ? x : y + nth; \
    int across = course.along_x ? min(y + nth, size.y - 1) : x; \
    int row = min(course.upwards ? along : course.rows - 1 - along, course.rows - 1); \
    int line = across - drifted(course, row) - line_0; \
    int next = beside_of(course, row) > 0.0 ? line - 1 : line + 1; \
    uint own = lines[at + place_of(course, line >> 2, row)][line & 3]; \
    uint other = lines[at + place_of(course, next >> 2, row)][next & 3]; \
    vec2 tangents = min(relief * vec2(tangent_of(course, row, across, \
        own_row(int(own & 0xffffu)), far_row(int(other & 0xffffu)), foot[nth]), \
        tangent_of(turned(course), course.rows - 1 - row, across, own_row(int(own >> 16)), \
        far_row(int(other >> 16)), foot[nth])), HIGHEST); \
    ahead[nth] = mix(ahead[nth], vec4(tangents.x), channel); \
    behind[nth] = mix(behind[nth], vec4(tangents.y), channel); \
    total[nth] += sky_of_sector(tangents.x, slope[nth], towards, \
        shape) + sky_of_sector(tangents.y, slope[nth], -towards, shape); }
#define ADD_PAIR(number, lines) if (number < batch.end) { \
    vec2 towards = ways[number - batch.from]; \
    Course course = course_of(number - batch.from); \
    int line_0 = courses[number - batch.from].w; \
    bvec4 channel = equal(ivec4(number), batch.pairs == 1 ? ivec4(0) : ivec4(0, 1, 2, 3)); \
    ADD(0, lines) ADD(1, lines) ADD(2, lines) ADD(3, lines) ADD(4, lines) ADD(5, lines) \
        ADD(6, lines) ADD(7, lines) }
#define STORE(nth) if (y + nth < end) { \
    ivec2 texel = ivec2(x, y + nth); \
    float whole = max(total[nth], 0.0) / float(2 * batch.pairs) / sqrt(1.0 + dot(slope[nth], \
        slope[nth])); \
    sky[texel.y * size.x + texel.x] = batch.end == batch.pairs ? whole : total[nth]; \
    if (keep && batch.from < 4) imageStore(out_ahead, texel, ahead[nth]); \
    if (keep && batch.from < 4) imageStore(out_behind, texel, behind[nth]); }

// Each thread has a column of the terrain's texels, eight rows at a time.
void sum(Batch batch) {
    int x = int(gl_GlobalInvocationID.x);
    int end = x < size.x ? min(int(gl_WorkGroupID.y + 1u) * CHUNK, size.y) : 0;
    float shape = sector_shape(2 * batch.pairs);
    vec2 metres = spacing_of(size, extent);
    for (int k = 0; k < batch.end - batch.from; k++) {
        ways[k] = pair_towards(batch.from + k, batch.pairs, first);
        Course course = course_towards(ways[k], size, metres);
        courses[k] = ivec4(course.drift, course.along_x, course.upwards, first_line(course));
        steeps[k] = course.steep;
    }
    for (int y = int(gl_WorkGroupID.y) * CHUNK; y < end; y += 8) {
        vec2 slope[8];
        float total[8];
        float foot[8];
        vec4 ahead[8], behind[8];
        UP_TO_8(BEGIN)
        for (int pair = batch.from; pair < batch.end; pair += 2) {
            int at = batch.apart * ((pair - batch.from) >> 1);
            ADD_PAIR(pair, even_lines)
            ADD_PAIR(pair + 1, odd_lines)
        }
        UP_TO_8(STORE)
    }
}
#endif
#endif
