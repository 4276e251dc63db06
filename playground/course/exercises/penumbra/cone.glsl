// lighting/soft_cone/visibility.glsl -- how much of a cone towards the sun is free.
//
//   gives    visibility: the visible part of the sun, 0..1
//   needs    lighting/daylight_reading.glsl, lighting/march.glsl, lighting/parameters/
//   units    without unit; the cone's radius is measured upright, in metres
//   source   Belaiche 2010, section 4.4.2, eq. 4.3
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//
// The thesis's own method. Around the ray to the sun grows a cone, from radius 0 at the texel.
// Where terrain is at height H, the ray at HL and the cone's radius is r, the part
// ((HL + r) - H) / 2r of the cone is free; the least of all steps counts. Terrain over the whole
// cone hides the sun.
//
// delta_r is what the radius grows over one unit of path, heights and lengths in the same unit:
// the tangent of the cone's half angle, but for the radius being upright. The thesis adds it at
// every step, so that half the step makes the cone twice as wide: that remains a choice, and is
// the same at a step length of 1. With `at_ground` and no delta_r it is a cylinder.
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
uniform float at_ground = 0.0; //! slider(0, 200) step(1) group("Cone") unit("m")
                               //! The radius where the ray begins, on the ground
#include "lighting/parameters/form.glsl"
#include "lighting/parameters/march.glsl"
uniform int max_distance = 0;  //! slider(0, 4096) group("March") unit("texels")
                               //! In the march, terrain farther than this throws no shadow, and in
                               //! the last quarter less of one; 0: all of it does

float free_part(float clearance, float radius);
float faded(float part, float step_from_ground);

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    float level = length(light.xy);
    if (form == SWEEP && matches_horizon) {
        return free_part(light.z - texelFetch(horizon, texel, 0).r * level, delta_r);
    }
    vec2 place = place_on(textureSize(height, 0), texel, size);
    March march = march_from(height, place, light, extent, relief, step_length);
    float spread = growth == 1 ? delta_r / step_length : delta_r;
    float visible = at_ground > 0.0 ? 0.5 : 1.0;  // of the ground itself, a half
    // Under the zenith the cone is over the texel itself, which only a very wide one notices.
    if (level < 1e-6) visible = min(visible, free_part(light.z, delta_r));
    for (int i = 1; i <= march.count; i++) {
        float t = float(i) * march.path;                        // metres from the ground
        float ray = march.foot + float(i) * march.climb;
        float terrain = terrain_at(height, march, i, sampling);
        float radius = at_ground;
        visible = min(visible, faded(free_part(ray - terrain, radius), float(i)));
    }
    return visible;
}

// The free part of a cone of that radius, whose middle is so high over the terrain.
float free_part(float clearance, float radius) {
    return clamp(0.5 + clearance / max(2.0 * radius, 1e-20), 0.0, 1.0);
}

// Less of what is hidden counts near the max distance: in a part of a larger terrain, what its
// texture does not hold must not count for some texels only.
float faded(float part, float step_from_ground) {
    if (max_distance == 0) return part;
    float last_step = float(max_distance) / step_length;
    float fade = clamp((step_from_ground - 0.75 * last_step) * (4.0 / last_step), 0.0, 1.0);
    return mix(part, 1.0, fade);
}
