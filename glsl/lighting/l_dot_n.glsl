// lighting/l_dot_n.glsl -- light by how squarely the sun meets the slope; nothing throws a shadow.
//
//   gives    light: red, green, blue; alpha the visible part of the sun, here always 1
//   needs    lighting/daylight_reading.glsl, lighting/sun.glsl, terrain/heightfield.glsl
//   units    light without unit, 1 for white; not cut at 1, that is the view's to do
//   source   Belaiche 2010, section 3.5.3
//   tested   tests/glsl/test_lighting.py, against inclined planes and NumPy
//
// light = sun colour max(0, N·L) gain + sky colour ambient. The thesis gives no number for
// its gain in section 3.5.3 and 2 in 5.4. Its ambient light is 0: shadows are pitch black.
// The light map may have another size than the heights; slopes are metres over metres.
#include "lighting/daylight_reading.glsl"
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D height;                //! input
#include "lighting/parameters/sun.glsl"
#include "lighting/parameters/sunlight.glsl"
#include "lighting/parameters/skylight.glsl"
#include "lighting/parameters/normal.glsl"

vec4 kernel(ivec2 texel) {
    // anchor: slope
    ivec2 grid = textureSize(height, 0);
    vec2 metres = spacing_of(grid, extent);
    vec2 slope = relief * (matches_height ? slope_of_node(height, texel, metres, normal)
                           : slope_at(height, place_on(grid, texel, size), metres, normal));
    // end: slope
    Sunlight from = sunlight(wired_daylight, daylight, towards_sun, sun, sun_colour, sky_colour);
    float received = gain * sun_on(normal_of_slope(slope), from.direction);
    return vec4(from.sun * received + from.sky * ambient, 1.0);
}
