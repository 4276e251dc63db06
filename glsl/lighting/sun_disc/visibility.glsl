// lighting/sun_disc/visibility.glsl -- how much of the sun's disc is over the horizon.
//
//   gives    visibility: the visible part of the disc's area, 0..1
//   needs    lighting/daylight_reading.glsl, lighting/march.glsl, lighting/sun_disc/area.glsl,
//            lighting/parameters/
//   units    without unit; angles in degrees
//   source   beyond Belaiche 2010, whose eqs 3.8 and 4.3 fall evenly across the sun; the sun's
//            diameter from section 3.4
//   tested   tests/glsl/test_shadows.py, against quadrature of the disc over a horizon in NumPy
//
// The horizon is that of the sun's own azimuth, and is taken to be level across the disc: it is
// half a degree wide, and few ridges turn much in that. Beyond its edges the terrain is taken for
// a plain without end, so no horizon is below 0, and the sun sets evenly there.
#include "lighting/daylight_reading.glsl"
#include "lighting/march.glsl"
#include "lighting/sun_disc/area.glsl"
#pragma kernel(output = "visibility:r32f")

#include "lighting/parameters/sun.glsl"
uniform float diameter = 0.53;  //! slider(0.1, 20) step(0.01) group("Sun") unit("°")
                                //! How wide the sun is
#include "lighting/parameters/form.glsl"
#include "lighting/parameters/march.glsl"

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    float elevation = sun_elevation(wired_daylight, daylight, sun);
    if (form == SWEEP && matches_horizon) {
        return disc_over(max(texelFetch(horizon, texel, 0).r, 0.0), elevation, diameter);
    }
    vec2 place = place_on(textureSize(height, 0), texel, size);
    March march = march_from(height, place, light, extent, relief, step_length);
    float tangent = 0.0;
    for (int i = 1; i <= march.count; i++) {
        float rise = terrain_at(height, march, i, sampling) - march.foot;
        tangent = max(tangent, rise / (float(i) * march.run));
    }
    return disc_over(tangent, elevation, diameter);
}
