// lighting/soft_cone/visibility.glsl -- how much of a cone towards the sun is free.
//
//   gives    visibility: the visible part of the sun, 0..1
//   needs    lighting/daylight_reading.glsl, lighting/march.glsl, lighting/parameters/; block
//            maxima and range of the heights, or their swept horizon, as inputs
//   units    without unit; the cone's radius is measured upright, in metres
//   source   Belaiche 2010, section 4.4.2, eq. 4.3
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//
// The thesis's own method. Around the ray to the sun grows a cone, from radius 0 at the texel.
// Where terrain is at height H, the ray at HL and the cone's radius is r, the part
// ((HL + r) - H) / 2r of the cone is free; the least of all steps counts. Terrain over the whole
// cone hides the sun.

// anchor: free-part
// The free part of a cone of that radius, whose middle is so high over the terrain.
float free_part(float clearance, float radius) {
    return clamp(0.5 + clearance / max(2.0 * radius, 1e-20), 0.0, 1.0);
}
// end: free-part

// delta_r is what the radius grows over one unit of path, heights and lengths in the same unit:
// the tangent of the cone's half angle, but for the radius being upright. The thesis adds it at
// every step, so that half the step makes the cone twice as wide: that remains a choice, and is
// the same at a step length of 1.
//
// In tangents of elevations the free part is 1/2 - (horizon - sun) cos(elevation) / (2 delta_r):
// so the sweep, which finds the horizon, gives it too.
#include "lighting/daylight_reading.glsl"
#include "lighting/march.glsl"
#pragma kernel(output = "visibility:r32f")

#include "lighting/parameters/sun.glsl"
uniform float delta_r = 0.01;  //! slider(0, 2) step(0.001) group("Cone") label("Δr")
                               //! What the cone's radius grows over one unit of path. The real
                               //! sun's is 0.0046
uniform int growth = 0;        //! menu("per unit of path", "per step") group("Cone")
                               //! What delta_r is counted by; the thesis counts steps, however
                               //! long they are
#include "lighting/parameters/form.glsl"
#include "lighting/parameters/march.glsl"
uniform int max_distance = 0;  //! slider(0, 4096) group("March") unit("texels")
                               //! In the march, terrain farther than this throws no shadow, and in
                               //! the last quarter less of one; 0: all of it does

float radius_a_step;  // what the radius grows from step to step  [m]

// How much a step is left out because it is far: for a part of a larger terrain, since what its
// texture does not hold must not count for some texels only.
float left_out(float t) {
    float last_step = float(max_distance) / step_length;
    return max_distance > 0 ? clamp((t - 0.75 * last_step) * (4.0 / last_step), 0.0, 1.0) : 0.0;
}

// anchor: cone
// The free part after a step: the least so far.
float after_step(float part, March march, float t, float terrain) {
    float ray = march.foot + t * march.climb;
    float open = free_part(ray - terrain, t * radius_a_step);
    return min(part, open + (1.0 - open) * left_out(t));
}
// end: cone

bool is_decided(float part) {
    return part == 0.0;
}

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    // A horizon of one texel was not swept: there are no compute shaders. A constant on a software
    // renderer, which then has no march to go through.
    bool swept = form == 1 && matches_horizon;
    // anchor: swept
    float level = length(light.xy);
    if (swept) return free_part(light.z - texelFetch(horizon, texel, 0).r * level, delta_r);
    // end: swept
    ivec2 grid = textureSize(height, 0);
    vec2 place = place_on(grid, texel, size);
    March march = march_from(height, place, size == grid, light, extent, relief, step_length);
    radius_a_step = delta_r * march.path / (growth == 1 ? step_length : 1.0);
    // With a delta_r over the sun's own climb the cone's lower side goes down, to the terrain's
    // edge.
    float lower_side = march.climb - radius_a_step;
    march.count = steps_below(march, lower_side, texelFetch(range, ivec2(0), 0).g * relief);
    if (max_distance > 0) march.count = min(march.count, int(float(max_distance) / step_length));
    // Under the zenith the cone is over the texel itself, which only a very wide one notices.
    float whole = level < 1e-6 ? free_part(light.z, delta_r) : 1.0;
    return marched(march, height, block_maxima, sampling, lower_side, whole);
}
