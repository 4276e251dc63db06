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

// The courses of a batch's pairs, in each thread: directions, and drift, axis, sense, first line.
vec2 directions_of[8];
ivec4 courses[8];

// Eight rows of a column of texels: their slopes, the sky that they see, and what goes into maps.
const int ROWS = 8;
vec2 slopes[ROWS];
float skies[ROWS];
vec4 ahead[ROWS];
vec4 behind[ROWS];

Course course_of(int number) {
    ivec4 stored = courses[number];
    Course course;
    course.drift = stored.x;
    course.along_x = stored.y == 1;
    course.upwards = stored.z == 1;
    course.rows = course.along_x ? size.x : size.y;
    course.across = course.along_x ? size.y : size.x;
    course.middle = course.upwards ? (course.rows - 1) >> 1 : course.rows >> 1;
    return course;
}

void load_row(int row, ivec2 texel, vec2 metres, bool goes_on) {
    slopes[row] = slope_here(texel, size, metres, relief, normal);
    skies[row] = goes_on ? sky[texel.y * size.x + texel.x] : 0.0;
    ahead[row] = keep && goes_on ? imageLoad(out_ahead, texel) : vec4(0.0);
    behind[row] = keep && goes_on ? imageLoad(out_behind, texel) : vec4(0.0);
}

// The tangents of the horizons in both directions of a pair, from where its sweeps left them.
vec2 tangents_at(ivec2 texel, Course course, int line_0, int at, int stride, int last) {
    int along = course.along_x ? texel.x : texel.y;
    int across = course.along_x ? texel.y : texel.x;
    int row = course.upwards ? along : course.rows - 1 - along;
    int line = across - drifted(course, row) - line_0;
    int back = course.rows - 1 - row;
    int word = line >> 1 & 1;
    // No place is beyond the last; but after a minimum llvmpipe's compiler does not compute places
    // again for each texel of eight, which takes as long as the rest.
    int there = min(at + place_of(course, line >> 2, row), last);
    int opposite = min(at + stride + place_of(course, line >> 2, back), last);
    uvec2 words = uvec2(lines[there][(row & 1) * 2 + word],
                        lines[opposite][(back & 1) * 2 + word]);
    return from_halves(words >> ((line & 1) << 4));
}

void add_pair(Batch batch, int pair, int x, int y, float shape, int last, const bool into_maps) {
    int at = 2 * batch.stride * (pair - batch.from);
    vec2 towards = directions_of[pair - batch.from];
    Course course = course_of(pair - batch.from);
    int line_0 = courses[pair - batch.from].w;
    bvec4 channel = equal(ivec4(pair), ivec4(0, 1, 2, 3));
    float weight = pair < batch.counted ? 1.0 : 0.0;
    for (int row = 0; row < ROWS; row++) {
        ivec2 texel = ivec2(x, min(y + row, size.y - 1));
        vec2 tangents = tangents_at(texel, course, line_0, at, batch.stride, last);
        skies[row] += weight * sky_of_sectors(tangents, slopes[row], towards, shape);
        if (into_maps) {
            ahead[row] = mix(ahead[row], vec4(tangents.x), channel);
            behind[row] = mix(behind[row], vec4(tangents.y), channel);
        }
    }
}

void store_row(int row, ivec2 texel, Batch batch) {
    float mean = max(skies[row], 0.0) / float(2 * batch.counted)
            / sqrt(1.0 + dot(slopes[row], slopes[row]));
    sky[texel.y * size.x + texel.x] = batch.end == batch.pairs ? mean : skies[row];
    if (keep && batch.from < 4) {
        imageStore(out_ahead, texel, ahead[row]);
        imageStore(out_behind, texel, behind[row]);
    }
}

// Each thread has a column of the terrain's texels, eight rows at a time. A sum that goes on has
// sums of other pairs before it.
void sum(Batch batch, bool goes_on) {
    int x = int(gl_GlobalInvocationID.x);
    int end = x < size.x ? min(int(gl_WorkGroupID.y + 1u) * CHUNK, size.y) : 0;
    float shape = sector_shape(2 * batch.counted);
    vec2 metres = spacing_of(size, extent);
    for (int k = 0; k < batch.end - batch.from; k++) {
        directions_of[k] = pair_towards(batch.from + k, batch.pairs, first);
        Course course = course_towards(directions_of[k], size, metres);
        courses[k] = ivec4(course.drift, course.along_x, course.upwards, first_line(course));
    }
    int last = lines.length() - 1;
    int end_of_maps = keep ? min(batch.end, 4) : batch.from;
    for (int y = int(gl_WorkGroupID.y) * CHUNK; y < end; y += ROWS) {
        for (int row = 0; row < ROWS; row++) {
            load_row(row, ivec2(x, min(y + row, size.y - 1)), metres, goes_on);
        }
        int pair = batch.from;
        for (; pair < end_of_maps; pair++) add_pair(batch, pair, x, y, shape, last, true);
        for (; pair < batch.end; pair++) add_pair(batch, pair, x, y, shape, last, false);
        for (int row = 0; row < ROWS; row++) {
            if (y + row < end) store_row(row, ivec2(x, y + row), batch);
        }
    }
}
#endif
#endif
