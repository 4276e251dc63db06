// lighting/ray_cast/visibility.glsl -- whether a ray towards the sun meets terrain.
//
//   gives    visibility: the visible part of the sun, 1 where no terrain is in the way, else 0
//   needs    lighting/daylight_reading.glsl, lighting/march.glsl, lighting/parameters/
//   units    without unit
//   source   Belaiche 2010, section 3.5.4
//   tested   tests/glsl/test_lighting.py and tests/glsl/test_shadows.py, against marches in NumPy
//            and walls' shadows in metres
//
// From each texel's own height a ray goes to the sun, a step at a time. Terrain above the ray
// hides the sun; a ray that leaves the terrain is free. By the form "sweep" the horizon towards
// the sun is known (lighting/sun_sweep), and is compared instead.
//
// Different from the thesis: it reads the texel that the ray's place is cut down to, which moves
// every shadow half a texel to the south-west; here heights are interpolated between texels'
// centres, and the terrain ends at the last one. Its method remains a choice, for comparison.
#include "lighting/daylight_reading.glsl"
#include "lighting/march.glsl"
#pragma kernel(output = "visibility:r32f")

#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/form.glsl"
#include "lighting/parameters/march.glsl"

float kernel(ivec2 texel) {
    vec3 light = sun_direction(wired_daylight, daylight, towards_sun);
    if (light.z < 0.0) return 0.0;
    if (form == SWEEP && matches_horizon) {
        return texelFetch(horizon, texel, 0).r * length(light.xy) > light.z ? 0.0 : 1.0;
    }
    vec2 place = place_on(textureSize(height, 0), texel, size);
    return 1.0;
}
