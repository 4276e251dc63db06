// lighting/soft_cone/leaping.glsl -- cones towards the sun that leap over low terrain.
//
//   gives    visibility, as lighting/soft_cone/visibility.glsl
//   needs    lighting/daylight_reading.glsl, lighting/leaps.glsl, lighting/parameters/; block
//            maxima of the heights and their range as inputs
//   units    without unit
//   source   as lighting/leaps.glsl
//   tested   tests/glsl/test_fast_variants.py, against lighting/soft_cone/visibility.glsl
#include "lighting/daylight_reading.glsl"
#include "lighting/leaps.glsl"
#pragma kernel(output = "visibility:r32f")

uniform sampler2D block_maxima;  //! input
uniform sampler2D range;         //! input
#include "lighting/parameters/sun.glsl"
uniform float delta_r = 0.01;  //! slider(0, 2) step(0.001) group("Cone") label("Δr")
                               //! What the cone's radius grows over one unit of path. The real
                               //! sun's is 0.0046
uniform int growth = 0;        //! menu("per unit of path", "per step") group("Cone")
                               //! What delta_r is counted by; the thesis counts steps, however
                               //! long they are
uniform float at_ground = 0.0; //! slider(0, 200) step(1) group("Cone") unit("m")
                               //! The radius where the ray begins, on the ground
#include "lighting/parameters/form.glsl"
#include "lighting/parameters/march.glsl"
uniform int max_distance = 0;  //! slider(0, 4096) group("March") unit("texels")
                               //! In the march, terrain farther than this throws no shadow, and in
                               //! the last quarter less of one; 0: all of it does

float radius_a_step;  // what the radius grows from step to step  [m]

float free_part(float clearance, float radius) {
    return clamp(0.5 + clearance / max(2.0 * radius, 1e-20), 0.0, 1.0);
}

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    float level = length(light.xy);
    // A constant on a software renderer, which then has no march to go through.
    bool swept = form == SWEEP && matches_horizon;
    if (swept) return free_part(light.z - texelFetch(horizon, texel, 0).r * level, delta_r);
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    March march = march_from(height, place, light, extent, relief, step_length);
    radius_a_step = delta_r * march.path / (growth == 1 ? step_length : 1.0);
    // With a delta_r over the sun's own climb the cone's lower side goes down, to the terrain's
    // edge. With a radius on the ground nothing is leapt over.
    float lower_side = at_ground > 0.0 ? -1e30 : march.climb - radius_a_step;
    march.count = steps_below(march, lower_side, texelFetch(range, ivec2(0), 0).g * relief);
    if (max_distance > 0) march.count = min(march.count, int(float(max_distance) / step_length));
    float whole = at_ground > 0.0 ? 0.5 : 1.0;
    if (level < 1e-6) whole = min(whole, free_part(light.z, delta_r));
    return leaping_march_from_texel(size == grid, march, height, block_maxima, sampling,
                                    lower_side, whole);
}

float after_step(float part, March march, float t, float terrain) {
    float clearance = march.foot + t * march.climb - terrain;
    float open = free_part(clearance, at_ground + t * radius_a_step);
    if (max_distance == 0) return min(part, open);
    float last_step = float(max_distance) / step_length;
    float fade = clamp((t - 0.75 * last_step) * (4.0 / last_step), 0.0, 1.0);
    return min(part, mix(open, 1.0, fade));
}

bool is_decided(float part) {
    return part == 0.0;
}
