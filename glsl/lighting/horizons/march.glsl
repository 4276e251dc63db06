// lighting/horizons/march.glsl -- the horizons around each texel, by a march in every direction.
//
//   gives    ahead, behind: tangents of the horizons' elevations in four directions and in the
//            four opposite; sky: K(p), the share of an even sky's light; land: the heights here
//   needs    lighting/horizons/course.glsl, lighting/horizons/open_sky.glsl,
//            terrain/heightfield.glsl; the range of the heights
//   units    tangents are rises over runs, 0 and up, at most 60000; heights without unit
//   source   Belaiche 2010, section 3.4, after Max 1988, "Horizon Mapping: Shadows for Bump-Mapped
//            Surfaces"; K(p) by eqs 3.12 to 3.15
//   tested   tests/glsl/test_horizons.py, against brute force in float64
//
// The plain form: from each texel a march over the whole terrain, in steps of one row of the
// finer of two grids, the heights' and this pass's own. It ends where the highest terrain could
// not be seen over the horizon found so far. Heights count where the ray crosses a row,
// interpolated: a texel less than one texel beside the ray is seen in part. Between two rows a
// bilinear cell may stand higher by a quarter of its twist |a - b - c + d|; of a ridge one texel
// wide that runs across the rows, half of the height or more is seen. A step of the repeat
// marches in two opposite directions: no single draw lasts so long that a graphics driver would
// give it up. Half a texel beyond the terrain's edge a march leaves the terrain.
//
// Beyond the edge the sky is open, so that near it horizons are too low and K is too bright. Of
// 65 x 65 texels cut out of real terrain with slopes of 16 degrees the outermost have 0.01 too
// much in the mean, with slopes of 38 degrees 0.08, at worst 0.33; 16 texels further in it is a
// tenth of that. Where it counts, read a wider DEM than is shown.
#include "lighting/horizons/course.glsl"
#include "lighting/horizons/open_sky.glsl"
#include "lighting/horizons/slope.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "ahead:rgba16f, behind:rgba16f, sky:r32f, land:r32f", \
               repeat = "max(directions // 8 * 4, 4 if keep else 1)", relief = "shown")

uniform sampler2D height;               //! input
uniform sampler2D range;                //! input
#include "lighting/parameters/directions.glsl"
#include "lighting/parameters/normal.glsl"

float steepest_from(ivec2 grid, vec2 start, vec2 towards, vec2 metres, float foot, float highest);

void kernel(ivec2 texel, out vec4 ahead, out vec4 behind, out float sky, out float land) {
    ivec2 grid = max(textureSize(height, 0), size);
    vec2 start = place_on(grid, texel, size);
    vec2 metres = spacing_of(grid, extent);
    vec2 slope = slope_here(texel, size, spacing_of(size, extent), relief, normal);
    land = land_at(texel);
    float highest = texelFetch(range, ivec2(0), 0).g;
    // The maps hold eight directions, also where K counts two.
    int counted = pairs_of(directions);
    float shape = sector_shape(2 * counted);
    vec2 towards = pair_towards(iteration, iterations, first);
    float tangent = relief * steepest_from(grid, start, towards, metres, land, highest);
    float opposite = relief * steepest_from(grid, start, -towards, metres, land, highest);
    tangent = min(tangent, 60000.0);
    opposite = min(opposite, 60000.0);
    bvec4 channel = equal(ivec4(keep ? iteration : -1), ivec4(0, 1, 2, 3));
    ahead = mix(previous_ahead(texel), vec4(tangent), channel);
    behind = mix(previous_behind(texel), vec4(opposite), channel);
    float sectors = sky_of_sector(tangent, slope, towards, shape)
            + sky_of_sector(opposite, slope, -towards, shape);
    float sum = float(2 * counted) * sqrt(1.0 + dot(slope, slope));
    sky = previous_sky(texel) + (iteration < counted ? sectors / sum : 0.0);
    if (iteration == iterations - 1) sky = max(sky, 0.0);
}

float land_at(ivec2 texel) {
    return height_at(height, place_on(textureSize(height, 0), texel, size));
}

// The highest tangent on a march from a place on the grid, in rows and texels of the course.
float steepest_from(ivec2 grid, vec2 start, vec2 towards, vec2 metres, float foot, float highest) {
    Course course = course_towards(towards, grid, metres);
    float drift = float(course.drift) / 65536.0;
    float along = course.upwards ? 1.0 : -1.0;
    vec2 direction = course.along_x ? vec2(along, drift) : vec2(drift, along);
    vec2 edge = vec2(grid) - 0.5;
    vec2 scale = vec2(textureSize(height, 0) - 1) / vec2(max(grid - 1, ivec2(1)));
    bool on_texels = grid == textureSize(height, 0) && size == grid;
    ivec2 across = course.along_x ? ivec2(0, 1) : ivec2(1, 0);
    float max_rise = (highest - foot) * course.steep;
    float steepest = 0.0;
    // anchor: horizon
    for (int k = 1; k < course.rows; k++) {
        float rows = float(k);
        vec2 at = start + rows * direction;
        bool outside = any(lessThan(at, vec2(-0.5))) || any(greaterThan(at, edge));
        if (outside || max_rise <= steepest * rows) break;
        float height_there = on_texels ? height_on_line(height, at, across)
                : height_at(height, at * scale);
        steepest = max(steepest, (height_there - foot) * course.steep / rows);
    }
    // end: horizon
    return steepest;
}
