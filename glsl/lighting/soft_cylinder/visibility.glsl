// lighting/soft_cylinder/visibility.glsl -- how much of a cylinder towards the sun is free.
//
//   gives    visibility: the visible part of the sun, 0..1/2
//   needs    lighting/daylight_reading.glsl, lighting/march.glsl, lighting/parameters/
//   units    without unit; the cylinder's radius is measured upright
//   source   Belaiche 2010, section 4.4.1, eq. 4.3
//   tested   tests/glsl/test_shadows.py, against a march in NumPy
//
// The thesis's first attempt, kept because it fails, as the thesis shows in figures 4.4 and 4.5.
// The cylinder is as wide at its beginning as anywhere. So the texel's own ground hides its lower
// half, ((HL + r) - H) / 2r being 1/2 where HL is H; and neighbours no higher than the radius hide
// more.
//
// The radius is in the thesis's grey levels, of which there are 255 from height 0 to height 1.
#include "lighting/daylight_reading.glsl"
#include "lighting/march.glsl"
#pragma kernel(output = "visibility:r32f")

#include "lighting/parameters/sun.glsl"
uniform float radius = 0.5;  //! slider(0, 64) step(0.1) group("Cylinder") unit("grey levels")
                             //! Half of the cylinder's width; 255 grey levels are the height from
                             //! 0 to 1
#include "lighting/parameters/march.glsl"

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    vec2 place = place_on(textureSize(height, 0), texel, size);
    March march = march_from(height, place, light, extent, relief, step_length);
    float radius_in_metres = radius / 255.0 * relief;
    float visible = 0.5;  // the beginning leaves a half
    for (int i = 1; i <= march.count && visible > 0.0; i++) {
        float ray = march.foot + float(i) * march.climb;
        float clearance = ray - terrain_at(height, march, i, sampling);
        float part = 0.5 + clearance / max(2.0 * radius_in_metres, 1e-20);
        visible = min(visible, clamp(part, 0.0, 1.0));
    }
    return visible;
}
