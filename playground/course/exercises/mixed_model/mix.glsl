// generation/mixed/mix.glsl -- a shape, with layers of noise added as details.
//
//   gives    height; 0..1 where the shape is
//   needs    generation/layered_noise/weights.glsl
//   units    heights without unit
//   source   Belaiche 2010, section 4.3.1
//   tested   tests/glsl/test_layered_noise.py, against NumPy
//
// The shape is taken for one more layer, of weight 1. The details come divided by the sum of
// their weights, and are given their weights again here.
#include "generation/layered_noise/weights.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D shape;          //! input
uniform sampler2D detail;         //! input
uniform int octaves = 1;          //! slider(0, 8) Layers of detail
uniform float persistence = 0.04; //! slider(0, 1) step(0.01) Weight of the first layer of detail;
                                  //! each next layer has this share of it

float kernel(ivec2 texel) {
    return texelFetch(shape, texel, 0).r;  // and the details, with their weights
}
