// lighting/height_difference.glsl -- light by how much higher the next place towards the sun is.
//
//   gives    light: red, green, blue; alpha the share of light, 0..1
//   needs    lighting/sun.glsl, terrain/heightfield.glsl
//   units    heights and softness without unit, 1 is the relief; step_length in texels of the
//            heights
//   source   Belaiche 2010, section 3.5.1, where Reiter 1995 is cited for it (The Visual Computer
//            11, 6)
//   tested   tests/glsl/test_height_difference.py, against NumPy and planes
//
// share = 1 - (h(towards the sun) - h(here)) / softness, cut to 0..1, and 1 where the place
// towards the sun lies off the terrain. The sun's elevation plays no part: that is the method's
// defect, and why a terrain that falls away from the sun is as bright as a level one.
//
// The thesis names no number for its softness, and brings no light to 0..1; its place is a
// whole number of pixels away, here it is interpolated along the sun's azimuth. Its gain of 2
// (section 5.4) would make all level terrain twice white: here it is 1.
#include "lighting/sun.glsl"
#include "terrain/heightfield.glsl"
#pragma kernel(output = "light:rgba16f")

uniform sampler2D height;                //! input
#include "lighting/parameters/one_step.glsl"
uniform vec3 sun_colour = vec3(1.0);     //! colour group("Sun") Colour of the sun's light
uniform float gain = 1.0;                //! slider(0, 4) step(0.05) group("Sun")
                                         //! The sun's light is multiplied by it
#include "lighting/parameters/skylight.glsl"
uniform float softness = 0.05;           //! log_slider(0.001, 1)
                                         //! How much higher the place towards the sun may be
                                         //! before all light is gone. The less, the darker

float share_at(ivec2 grid, vec2 place) {
    vec2 direction = to_sun(vec2(sun.x, 0.0)).xy / spacing_of(grid, extent);
    vec2 towards = place + step_length * direction / max(abs(direction.x), abs(direction.y));
    vec2 last = vec2(grid - 1);
    // A step that ends on the edge counts as inside, despite rounding.
    bool off = any(lessThan(towards, vec2(-1e-3))) || any(greaterThan(towards, last + 1e-3));
    float rise = height_at(height, towards) - height_at(height, place);
    return off ? 1.0 : clamp(1.0 - rise / softness, 0.0, 1.0);
}

vec4 kernel(ivec2 texel) {
    ivec2 grid = textureSize(height, 0);
    float share = sun.y < 0.0 ? 0.0 : share_at(grid, place_on(grid, texel, size));
    return vec4(sun_colour * (gain * share) + sky_colour * ambient, share);
}
