// lighting/sun_image.glsl -- the sun's image, no brighter than a picture bears.
//
//   gives    SUN_OVER_WHITE, DAZZLING, sun_image
//   needs    colour/luminance.glsl
//   units    light without unit, 1 for white paper in the sun
//   source   none
//   tested   tests/glsl/test_daylight.py, the sun's disc; tests/glsl/test_scene_water.py, glints
#ifndef LIGHTING_SUN_IMAGE
#define LIGHTING_SUN_IMAGE
#include "colour/luminance.glsl"

const float SUN_OVER_WHITE = 46750.0;  // how much brighter it is than white paper in its light
const float DAZZLING = 60.0;  // more is past what half floats hold and smooth edges bear

// A beam so many times as bright.
vec3 sun_image(vec3 beam, float times) {
    return beam * min(times, DAZZLING / max(luminance(beam), 1e-9));
}
#endif
