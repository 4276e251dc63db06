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
// A sweep has left tangents in lines; a sum adds what sky they leave, and brings those of the
// chief directions into the maps.
#ifndef LIGHTING_HORIZONS_SUM
#define LIGHTING_HORIZONS_SUM
#ifdef COMPUTE_STAGE
#include "lighting/horizons/lines.glsl"
#include "lighting/horizons/open_sky.glsl"
#include "lighting/horizons/slope.glsl"
#include "maths/land.glsl"

// The courses of a batch's pairs, kept by each thread: directions, and drift, axis, sense, first
// line.
vec2 ways[8];
ivec4 courses[8];

Course course_of(int number) {
    ivec4 kept = courses[number];
    Course course;
    course.drift = kept.x;
    course.along_x = kept.y == 1;
    course.upwards = kept.z == 1;
    course.rows = course.along_x ? size.x : size.y;
    course.across = course.along_x ? size.y : size.x;
    course.middle = course.upwards ? (course.rows - 1) >> 1 : course.rows >> 1;
    return course;
}

#define BEGIN(nth) { \
    ivec2 texel = ivec2(x, min(y + nth, size.y - 1)); \
    slope[nth] = slope_here(texel, size, metres, relief, normal); \
    total[nth] = goes_on ? sky[texel.y * size.x + texel.x] : 0.0; \
    ahead[nth] = keep && goes_on ? imageLoad(out_ahead, texel) : vec4(0.0); \
    behind[nth] = keep && goes_on ? imageLoad(out_behind, texel) : vec4(0.0); }
#define ADD(nth) \
    int along = course.along_x ? x : y + nth; \
    int across = course.along_x ? min(y + nth, size.y - 1) : x; \
    int row = min(course.upwards ? along : course.rows - 1 - along, course.rows - 1); \
    int line = across - drifted(course, row) - line_0; \
    int back = course.rows - 1 - row; \
    int word = line >> 1 & 1; \
    int there = min(at + place_of(course, line >> 2, row), last); \
    int opposite = min(at + batch.apart + place_of(course, line >> 2, back), last); \
    uvec2 words = uvec2(lines[there][(row & 1) * 2 + word], \
                        lines[opposite][(back & 1) * 2 + word]); \
    vec2 tangents = from_halves(words >> ((line & 1) << 4)); \
    total[nth] += weight * sky_of_sectors(tangents, slope[nth], towards, shape);
#define ADD_ONLY(nth) { ADD(nth) }
#define ADD_AND_KEEP(nth) { \
    ADD(nth) \
    ahead[nth] = mix(ahead[nth], vec4(tangents.x), channel); \
    behind[nth] = mix(behind[nth], vec4(tangents.y), channel); }
#define ADD_PAIR(ADD_1) { \
    int at = 2 * batch.apart * (pair - batch.from); \
    vec2 towards = ways[pair - batch.from]; \
    Course course = course_of(pair - batch.from); \
    int line_0 = courses[pair - batch.from].w; \
    bvec4 channel = equal(ivec4(pair), ivec4(0, 1, 2, 3)); \
    float weight = pair < batch.counted ? 1.0 : 0.0; \
    ADD_1(0) ADD_1(1) ADD_1(2) ADD_1(3) ADD_1(4) \
        ADD_1(5) ADD_1(6) ADD_1(7) }
#define STORE(nth) if (y + nth < end) { \
    ivec2 texel = ivec2(x, y + nth); \
    float whole = max(total[nth], 0.0) / float(2 * batch.counted) / sqrt(1.0 + dot(slope[nth], \
        slope[nth])); \
    sky[texel.y * size.x + texel.x] = batch.end == batch.pairs ? whole : total[nth]; \
    if (keep && batch.from < 4) imageStore(out_ahead, texel, ahead[nth]); \
    if (keep && batch.from < 4) imageStore(out_behind, texel, behind[nth]); }

// Each thread has a column of the terrain's texels, eight rows at a time. A sum that goes on has
// sums of other pairs before it.
void sum(Batch batch, bool goes_on) {
    int x = int(gl_GlobalInvocationID.x);
    int end = x < size.x ? min(int(gl_WorkGroupID.y + 1u) * CHUNK, size.y) : 0;
    float shape = sector_shape(2 * batch.counted);
    vec2 metres = spacing_of(size, extent);
    for (int k = 0; k < batch.end - batch.from; k++) {
        ways[k] = pair_towards(batch.from + k, batch.pairs, first);
        Course course = course_towards(ways[k], size, metres);
        courses[k] = ivec4(course.drift, course.along_x, course.upwards, first_line(course));
    }
    // No place is beyond it; but after a minimum llvmpipe's compiler does not work out places
    // again for each texel of eight, which takes as long as the rest.
    int last = lines.length() - 1;
    int kept = keep ? min(batch.end, 4) : batch.from;
    for (int y = int(gl_WorkGroupID.y) * CHUNK; y < end; y += 8) {
        vec2 slope[8];
        float total[8];
        vec4 ahead[8], behind[8];
        UP_TO_8(BEGIN)
        int pair = batch.from;
        for (; pair < kept; pair++) ADD_PAIR(ADD_AND_KEEP)
        for (; pair < batch.end; pair++) ADD_PAIR(ADD_ONLY)
        UP_TO_8(STORE)
    }
}
#endif
#endif
