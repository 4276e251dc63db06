// lighting/sun_sweep.glsl -- the horizon towards the sun, along parallel lines of sight.
//
//   gives    horizon: tangents of the horizon's elevation, one a texel of the terrain
//   needs    lighting/daylight_reading.glsl, lighting/sun_sweep/lines.glsl, maths/land.glsl
//   units    rise over run; -10000 where there is no terrain towards the sun
//   source   lines of sight that texels share: V. Timonen and J. Westerholm 2010, "Scalable Height
//            Field Self-Shadowing" (Computer Graphics Forum 29); the four slopes: derived here
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//
// Let h(k) be the height where a line crosses the row that is k rows nearer to the sun, and h(0)
// that of a place on the line. For a slope s, in metres a row, lower a straight line of that slope
// onto the heights: it comes to rest on the one at
//
//     k(s) = argmax over k of h(k) - s k                  of several the nearest           (1)
//
// The horizon's tangent is looked for among these, for four slopes s around the sun's own:
//
//     T = max over s of (h(k(s)) - h(0)) / (k(s) run)     run: metres a row                (2)
//
// The true horizon is the greatest such tangent of all k. T is on the same side of each s as it:
// over s, in metres a row, is every height with h(k) - s k > h(0), and k(s) has the greatest of
// these. So a shadow's edge is the true one; only horizons far above or below the sun come out too
// low.
//
// A texel lies on a line or between two; its horizon is interpolated between theirs. A line passes
// between texels, and interpolation smooths its heights. Far away that hardly changes the horizon;
// close by it does. So the nearest rows are sampled on the texel's own way to the sun.
//
// `shape` and `spread` say how much of the sky the sun covers, and so where the slopes are. The
// methods of shadow sample the horizon at the terrain's own size only; at any other, which they
// ask for when they do not need it, it is -10000. Each texel looks along its lines anew;
// sun_sweep.comp next to it follows each line once. Where there are no compute shaders the
// methods march, which is much faster than this text.
//
// Against a march: hard shadows differ on at most 0.6 % of the texels of the terrains that ship,
// at a sun of 5 to 25 degrees, and at a shadow's edge; a soft part by 0.006 on average, by 0.02
// for a cone as wide as the night's. Along axes and diagonals they are the same but for rounding.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun_sweep/lines.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "horizon:r32f")

uniform sampler2D height;              //! input
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sun_shape.glsl"

// The heights of three texels of a row, from a line on.
vec3 heights_from(Lines lines, int row, int line) {
    if (row < 0) return vec3(NOWHERE);
    return heights_across(height, lines, row, across_at(lines, row, line), relief);
}

float height_of(Lines lines, int row, int line) {
    vec3 texels = heights_from(lines, row, line);
    return texels.x + (texels.y - texels.x) * part_at(lines, row);
}

// T from where a line crosses a row.
float horizon_on_line(Lines lines, int row, int line, vec4 slopes) {
    vec4 rests_on = vec4(NOWHERE);  // h(k(s)) of each slope, and k(s)
    vec4 rows = vec4(1.0);
    for (int k = row; k >= NEAR_ROWS; k--) {
        int there = row - k;
        if (!is_on_terrain(lines, across_at(lines, there, line), part_at(lines, there))) continue;
        vec4 terrain = vec4(height_of(lines, there, line));
        bvec4 higher = greaterThanEqual(terrain, rests_on - slopes * (rows - float(k)));
        rests_on = mix(rests_on, terrain, higher);
        rows = mix(rows, vec4(k), higher);
    }
    vec4 tangents = (rests_on - height_of(lines, row, line)) / (rows * lines.run);
    return max(max(max(tangents.x, tangents.y), max(tangents.z, tangents.w)), NO_HORIZON);
}

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    if (size != grid) return NO_HORIZON;
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    Lines lines = lines_towards(grid, light, spacing_of(grid, extent));
    vec4 slopes = slopes_around(lines, light, shape, spread);
    int row = row_and_across(lines, texel).x;
    int across = row_and_across(lines, texel).y;
    int line = across - across_at(lines, row, 0) - (part_at(lines, row) > 0.0 ? 1 : 0);
    float before = horizon_on_line(lines, row, line, slopes);
    float after = horizon_on_line(lines, row, line + 1, slopes);
    return horizon_of_texel(
        lines, row, across, before, after, height_across(height, lines, row, across) * relief,
        heights_from(lines, row - 1, line), heights_from(lines, row - 2, line),
        heights_from(lines, row - 3, line)
    );
}
