// texturing/mask.glsl -- a cover of metres, areas or discharges: nothing, all, and in between.
//
//   gives    cover, 0..1
//   needs    maths/land.glsl; what erosion and water give, one number a texel
//   units    `from` and `to` in the unit of what is wired; the cover without unit
//   source   none: made here; by the logarithm, for areas and discharges grow by factors
//   tested   tests/glsl/test_masks.py, against NumPy
//
// The cover stands in for a layer of texturing/alpha_map: inputs = { "weights.path" = "rivers" }.
#include "maths/land.glsl"
#pragma kernel(output = "cover:r16f")

uniform sampler2D amount;      //! input

uniform float from = 0.1;      //! log_slider(1e-6, 1e9) Where the cover begins
uniform float to = 10.0;       //! log_slider(1e-6, 1e9) Where it is whole
uniform bool by_factors = false;  //! Whether half of the cover is at the geometric mean of the two
                                  //! (areas, discharges), not at the mean (metres)
uniform float strength = 1.0;  //! slider(0, 1) step(0.01) How much it covers where it does

// Log 2, where there is something to take it of.
float magnitude(float number) {
    return by_factors ? log2(max(number, 1e-30)) : number;
}

float kernel(ivec2 texel) {
    ivec2 grid = textureSize(amount, 0);
    ivec2 there = ivec2(place_on(grid, texel, size) + 0.5);
    float found = texelFetch(amount, there, 0).r;
    float wide = magnitude(to) - magnitude(from);
    float part = abs(wide) > 1e-6 ? (magnitude(found) - magnitude(from)) / wide
                                  : float(found >= to);
    // What is not a number covers nothing, so that it stays visible as such in the view.
    return part >= 0.0 ? strength * min(part, 1.0) : 0.0;
}
