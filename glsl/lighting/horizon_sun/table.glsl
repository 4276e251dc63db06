// lighting/horizon_sun/table.glsl -- the sun's light on a surface, for all normals at once.
//
//   gives    table: red, green, blue; alpha 1 where the surface faces the sun
//   needs    lighting/daylight_reading.glsl
//   units    light without unit; texel (i, j) is the normal with x = (i - 128) / 127, y = (j -
//            128) / 127
//   source   Belaiche 2010, section 3.4, eq. 3.7
//   tested   tests/glsl/test_analytic.py, against float64
//
// 256 x 256 normals, a sixteenth of a light map of 1025 x 1025. Clouds dim the sun alone.
#include "lighting/daylight_reading.glsl"
#pragma kernel(output = "table:rgba16f")

#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sunlight.glsl"
uniform float clouds = 0.0;              //! slider(0, 1) step(0.01) group("Sun")
                                         //! How much of the sun's light clouds keep back

vec4 kernel(ivec2 texel) {
    vec2 level = (vec2(texel) - 128.0) / 127.0;
    vec3 normal = vec3(level, sqrt(max(1.0 - dot(level, level), 0.0)));
    Sunlight given = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, vec3(0.0));
    float received = max(dot(normal, given.direction), 0.0);
    return vec4(given.sun * (gain * (1.0 - clouds) * received), received > 0.0 ? 1.0 : 0.0);
}
