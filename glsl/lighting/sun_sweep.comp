// lighting/sun_sweep.comp -- the horizon towards the sun, each line of sight followed once.
//
//   gives    horizon: tangents of the horizon's elevation, one a texel of the terrain
//   needs    lighting/daylight_reading.glsl, lighting/sun_sweep/lines.glsl, maths/land.glsl
//   units    rise over run; -10000 where there is no terrain towards the sun
//   source   see the kernel next to it
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//   agrees   exactly: k(s) of the heights up to a row is k(s) of those up to the row before it, or
//            the row itself; so each row compares what the kernel compares, in the same order
//
// Two lines, a texel apart, bound a band, and each texel of a row is in one band: on its first
// line or between. A thread has four adjacent bands: five lines and six texels a row,
// where four threads would have eight and twelve. It follows the lines from the sun's side, and
// keeps for each of the four slopes the point that a line of that slope rests on: a fixed amount
// of work a row. Bands that begin outside the terrain enter it later.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun_sweep/lines.glsl"
#include "maths/land.glsl"
#pragma compute(groups = "(size.x + size.y + 127) // 128, 1", local = "32, 1", \
                buffers = "horizon:float:size.x * size.y", overwrites = "horizon", \
                aligned = "4", agrees = "exact")

uniform sampler2D height;              //! input
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sun_shape.glsl"

const int BANDS = 4;  // that a thread has

// For each of four slopes, the point that a line of that slope rests on: its height, and how many
// rows ago it was.
struct Points {
    vec4 height;
    vec4 rows;
};

// A row further on: the height NEAR_ROWS back counts from here.
Points one_row_on(Points points, float height, vec4 slopes) {
    vec4 rows = points.rows + 1.0;
    bvec4 higher = greaterThanEqual(vec4(height),
                                    points.height - slopes * (rows - float(NEAR_ROWS)));
    return Points(mix(points.height, vec4(height), higher), mix(rows, vec4(NEAR_ROWS), higher));
}

float horizon_over(Points points, float height, float run) {
    vec4 tangent = (points.height - height) / (points.rows * run);
    return max(max(max(tangent.x, tangent.y), max(tangent.z, tangent.w)), NO_HORIZON);
}

// The rows on which a band may hold texels, with those that are near the first; as many rows as
// lines need to cross the terrain, at most.
int first_row(Lines lines, int line) {
    int start = lines.drift > 0.0 ? -1 : lines.last + 1;
    float entry = lines.drift == 0.0 ? 0.0 : float(start - line) / lines.drift;
    return max(int(clamp(entry, 0.0, float(lines.rows))) - NEAR_ROWS - 1, 0);
}
int row_after_last(Lines lines, int line) {
    int end = lines.drift > 0.0 ? lines.last + 1 : -1;
    float leave = lines.drift == 0.0 ? float(lines.rows) : float(end - line) / lines.drift;
    return min(int(clamp(leave, -2.0, float(lines.rows))) + 2, lines.rows);
}

// Loops over lines and texels have the length of the array that they index: compilers then unroll
// them, and the arrays need no memory.
const int LINES = BANDS + 1;
const int TEXELS = BANDS + 2;

// The heights of texels from the first line on, on this row and one to three rows ago.
float texels[TEXELS];
float texels1[TEXELS];
float texels2[TEXELS];
float texels3[TEXELS];
// The heights of the lines one to four rows ago: NOWHERE beside the terrain.
float feet1[LINES];
float feet2[LINES];
float feet3[LINES];
float feet4[LINES];
Points points[LINES];
float horizons[LINES];  // that the lines have found

// The height at a texel: the same as texelFetch gives, in half the time on llvmpipe, which looks
// up the level of texelFetch for each texel again.
float height_in_middle(ivec2 texel) {
    return textureLod(height, (vec2(texel) + 0.5) / vec2(size), 0.0).r;
}

void begin() {
    for (int n = 0; n < TEXELS; n++) {
        texels[n] = NOWHERE;
        texels1[n] = NOWHERE;
        texels2[n] = NOWHERE;
    }
    for (int n = 0; n < LINES; n++) {
        feet1[n] = NOWHERE;
        feet2[n] = NOWHERE;
        feet3[n] = NOWHERE;
        feet4[n] = NOWHERE;
        points[n] = Points(vec4(NOWHERE), vec4(1.0));
    }
}

void read_row(Lines lines, int row, int across) {
    for (int n = 0; n < TEXELS; n++) {
        texels3[n] = texels2[n];
        texels2[n] = texels1[n];
        texels1[n] = texels[n];
        ivec2 texel = texel_on(lines, row, clamp(across + n, 0, lines.last));
        texels[n] = relief * height_in_middle(texel);
    }
}

void follow_lines(Lines lines, int across, float part, vec4 slopes) {
    for (int n = 0; n < LINES; n++) {
        points[n] = one_row_on(points[n], feet4[n], slopes);
        float foot = texels[n] + (texels[n + 1] - texels[n]) * part;
        horizons[n] = horizon_over(points[n], foot, lines.run);
        feet4[n] = feet3[n];
        feet3[n] = feet2[n];
        feet2[n] = feet1[n];
        feet1[n] = is_on_terrain(lines, across + n, part) ? foot : NOWHERE;
    }
}

void fill_bands(Lines lines, int row, int across, bool between) {
    for (int n = 0; n < BANDS; n++) {
        int at = across + n + (between ? 1 : 0);
        float tangent = horizon_of_texel(
            lines, row, at, horizons[n], horizons[n + 1], between ? texels[n + 1] : texels[n],
            vec3(texels1[n], texels1[n + 1], texels1[n + 2]),
            vec3(texels2[n], texels2[n + 1], texels2[n + 2]),
            vec3(texels3[n], texels3[n + 1], texels3[n + 2]));
        ivec2 texel = texel_on(lines, row, at);
        if (at >= 0 && at <= lines.last) horizon[texel.y * size.x + texel.x] = tangent;
    }
}

// Adjacent bands, from a line on.
void sweep(Lines lines, int line, vec4 slopes) {
    int last_line = line + BANDS - 1;
    int first = min(first_row(lines, line), first_row(lines, last_line));
    int end = max(row_after_last(lines, line), row_after_last(lines, last_line));
    begin();
    for (int row = first; row < end; row++) {
        int across = across_at(lines, row, line);
        float part = part_at(lines, row);
        read_row(lines, row, across);
        follow_lines(lines, across, part, slopes);
        fill_bands(lines, row, across, part > 0.0);
    }
}

void main() {
    ivec2 grid = textureSize(height, 0);
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    int thread = int(gl_GlobalInvocationID.x);
    if (size == grid) {
        Lines lines = lines_towards(grid, light, spacing_of(grid, extent));
        int line = BANDS * thread - 1 - max(across_at(lines, lines.rows - 1, 0), 0);
        sweep(lines, line, slopes_around(lines, light, shape, spread));
    } else {
        for (int i = thread; i < size.x * size.y; i += 32 * int(gl_NumWorkGroups.x)) {
            horizon[i] = NO_HORIZON;
        }
    }
}
