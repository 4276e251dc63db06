// lighting/march.glsl -- a ray march over the terrain towards a light.
//
//   gives    March, march_from, terrain_at, sampled_height, INTERPOLATED, CUT_DOWN, SWEEP
//   needs    terrain/heightfield.glsl; heights come as an argument
//   units    places in texels; heights and lengths in metres
//   source   Belaiche 2010, section 3.5.4
//   tested   tests/glsl/test_shadows.py, against a march in NumPy; tests/glsl/test_lighting.py
//
// A ray starts at a place's own height and climbs towards the light in equal steps, `step_length`
// texels long along the axis that it follows more. A method of shadows compares it with the
// terrain at each step:
//
//     March march = march_from(height, place, light, extent, relief, step_length);
//     for (int i = 1; i <= march.count; i++) {
//         float ray = march.foot + float(i) * march.climb;
//         float terrain = terrain_at(height, march, i, sampling);
//         …
//     }
#ifndef LIGHTING_MARCH
#define LIGHTING_MARCH
#include "terrain/heightfield.glsl"

struct March {
    vec2 start;    // texels
    vec2 ahead;    // texels a step
    float relief;  // metres from height 0 to height 1
    float foot;    // the height where it begins   [m]
    float climb;   // of the ray, a step           [m]
    float path;    // length of a step on the ray  [m]
    float run;     // and on level ground          [m]
    int count;     // steps that stay on the terrain
};

// How heights between texels are sampled.
const int INTERPOLATED = 0;
const int CUT_DOWN = 1;  // the thesis's: of the texel that a place is cut down to

// The form of a method of shadows that compares a horizon (lighting/sun_sweep) and does not march.
const int SWEEP = 1;

int steps_on_terrain(vec2 start, vec2 ahead, vec2 last);

// A march from a place on the heights towards a light, which is a unit vector.
March march_from(sampler2D field, vec2 place, vec3 light, vec2 extent_in_metres,
                 float metres_of_relief, float step_length) {
    ivec2 grid = textureSize(field, 0);
    vec2 direction = light.xy / spacing_of(grid, extent_in_metres);
    // A ray straight up leaves its texel nowhere: it takes no step, and its numbers stay finite.
    float longer = max(max(abs(direction.x), abs(direction.y)), 1e-12);
    bool along_x = abs(direction.x) >= abs(direction.y);
    March march;
    march.start = place;
    // Whole texels along the longer axis must stay whole, which division does not promise.
    march.ahead = step_length * vec2(along_x ? sign(direction.x) : direction.x / longer,
                                     along_x ? direction.y / longer : sign(direction.y));
    march.relief = metres_of_relief;
    march.foot = height_at(field, place) * metres_of_relief;
    march.climb = step_length * light.z / longer;
    march.path = step_length / longer;
    march.run = march.path * length(light.xy);
    march.count = steps_on_terrain(place, march.ahead, vec2(grid - 1));
    if (length(light.xy) < 1e-6) march.count = 0;
    return march;
}

// The height at a place, without unit, by a sampling.
float sampled_height(sampler2D field, vec2 place, int sampling) {
    if (sampling != CUT_DOWN) return height_at(field, place);
    ivec2 last = textureSize(field, 0) - 1;
    return texelFetch(field, clamp(ivec2(place), ivec2(0), last), 0).r;
}

// The terrain's height at a step [m]. One multiplication for both samplings: a compiler rounds the
// same whether it knows the sampling or not.
float terrain_at(sampler2D field, March march, int i, int sampling) {
    vec2 place = march.start + float(i) * march.ahead;
    return sampled_height(field, place, sampling) * march.relief;
}

// Steps until a place leaves 0..last along one axis.
float steps_inside(float place, float ahead, float last) {
    if (ahead == 0.0) return 1e9;
    return (ahead > 0.0 ? last - place : place) / abs(ahead);
}

// Whole steps, of so many: one that ends on the edge counts, despite rounding. The limit is
// over four times the texels that a texture may have a side, and far below the largest int.
const float MAX_STEPS = 1e6;
int whole_steps(float steps) {
    return int(clamp(steps + 1e-3, 0.0, MAX_STEPS));
}

int steps_on_terrain(vec2 start, vec2 ahead, vec2 last) {
    return whole_steps(min(steps_inside(start.x, ahead.x, last.x),
                           steps_inside(start.y, ahead.y, last.y)));
}
#endif
