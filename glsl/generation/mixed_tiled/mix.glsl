// generation/mixed_tiled/mix.glsl -- a shape, with one tile of details added to each of its parts.
//
//   gives    height; 0..1 where the shape is
//   needs    generation/layered_noise/parts.glsl, generation/layered_noise/weights.glsl
//   units    heights without unit
//   source   Belaiche 2010, sections 4.3.1 and 4.3.2
//   tested   tests/glsl/test_layered_noise.py, against NumPy
#include "generation/layered_noise/parts.glsl"
#include "generation/layered_noise/weights.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D shape;          //! input
uniform sampler2D tile;           //! input
uniform int tiles = 4;            //! slider(1, 64) Parts a side
uniform int octaves = 1;          //! slider(0, 8) Layers of detail
uniform float persistence = 0.04; //! slider(0, 1) step(0.01) Weight of the first layer of detail;
                                  //! each next layer has this share of it

float kernel(ivec2 texel) {
    ivec2 place = place_in_part(texel, textureSize(tile, 0), tiles);
    float weights = sum_of_weights(0, octaves, persistence);
    float details = texelFetch(tile, place, 0).r * weights;
    return (details + texelFetch(shape, texel, 0).r) / (weights + 1.0);
}
