// water/wetness.glsl -- how wet the ground is: where much drains through and little falls.
//
//   gives    wetness, 0..1
//   needs    terrain/heightfield.glsl
//   units    heights without unit, areas in m^2; the index is a natural logarithm of metres
//   source   Beven and Kirkby 1979, "A physically based, variable contributing area model of basin
//            hydrology", Hydrological Sciences Bulletin 24: ln(a / tan slope), a the drained area
//            over the width that it drains through
//   tested   tests/glsl/test_rivers.py, on planes
#include "terrain/heightfield.glsl"
#pragma kernel(output = "wetness:r32f")

uniform sampler2D height;   //! input
uniform sampler2D area;     //! input
uniform float dry = 5.0;    //! slider(0, 20) step(0.1) The index of dry ground
uniform float wet = 14.0;   //! slider(0, 25) step(0.1) The index of wet ground

const float LEAST_SLOPE = 1e-3;  // a plain: the index of a lake would have no bound

float kernel(ivec2 texel) {
    vec2 slope = relief * slope_at(height, vec2(texel), spacing, CENTRAL_DIFFERENCES);
    float width = 0.5 * (spacing.x + spacing.y);
    float drained = max(texelFetch(area, texel, 0).r, 1e-6) / width;
    float index = log(drained / max(length(slope), LEAST_SLOPE));
    return clamp((index - dry) / max(wet - dry, 1e-3), 0.0, 1.0);
}
