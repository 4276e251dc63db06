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
// line or between. A thread has a band. It follows both lines from the sun's side, and keeps for
// each of the four slopes the point that a line of that slope rests on: a fixed amount of work a
// row. Bands that begin beside the terrain enter it later.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun_sweep/lines.glsl"
#include "maths/land.glsl"
#pragma compute(groups = "(size.x + size.y + 63) // 64, 1", local = "64, 1", \
                buffers = "horizon:float:size.x * size.y", overwrites = "horizon", \
                aligned = "4", agrees = "exact")

uniform sampler2D height;              //! input
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sun_shape.glsl"

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

void sweep(Lines lines, int line, vec4 slopes) {
    // Of this row and of one to three rows ago: the heights of three texels from the band on.
    vec3 texels = vec3(NOWHERE);
    vec3 texels1 = texels;
    vec3 texels2 = texels;
    vec3 texels3 = texels;
    // The heights of both lines, one to four rows ago; NOWHERE beside the terrain.
    vec2 feet1 = vec2(NOWHERE);
    vec2 feet2 = feet1;
    vec2 feet3 = feet1;
    vec2 feet4 = feet1;
    Points before = Points(vec4(NOWHERE), vec4(1.0));
    Points after = before;
    int end = row_after_last(lines, line);
    for (int row = first_row(lines, line); row < end; row++) {
        before = one_row_on(before, feet4.x, slopes);
        after = one_row_on(after, feet4.y, slopes);
        texels3 = texels2;
        texels2 = texels1;
        texels1 = texels;
        int across = across_at(lines, row, line);
        float part = part_at(lines, row);
        texels = heights_across(height, lines, row, across, relief);
        vec2 feet = texels.xy + (texels.yz - texels.xy) * part;
        feet4 = feet3;
        feet3 = feet2;
        feet2 = feet1;
        feet1 = vec2(is_on_terrain(lines, across, part) ? feet.x : NOWHERE,
                     is_on_terrain(lines, across + 1, part) ? feet.y : NOWHERE);
        bool between = part > 0.0;
        int at = across + (between ? 1 : 0);
        float tangent = horizon_of_texel(
            lines, row, at, horizon_over(before, feet.x, lines.run),
            horizon_over(after, feet.y, lines.run), between ? texels.y : texels.x,
            texels1, texels2, texels3
        );
        ivec2 texel = texel_on(lines, row, at);
        if (at >= 0 && at <= lines.last) horizon[texel.y * size.x + texel.x] = tangent;
    }
}

void main() {
    ivec2 grid = textureSize(height, 0);
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    int thread = int(gl_GlobalInvocationID.x);
    if (size == grid) {
        Lines lines = lines_towards(grid, light, spacing_of(grid, extent));
        int line = thread - 1 - max(across_at(lines, lines.rows - 1, 0), 0);
        sweep(lines, line, slopes_around(lines, light, shape, spread));
    } else {
        for (int i = thread; i < size.x * size.y; i += 64 * int(gl_NumWorkGroups.x)) {
            horizon[i] = NO_HORIZON;
        }
    }
}
