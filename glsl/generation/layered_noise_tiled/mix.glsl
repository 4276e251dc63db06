// generation/layered_noise_tiled/mix.glsl -- the coarsest layer, and a tile of the finer ones.
//
//   gives    height, 0..1
//   needs    generation/layered_noise/parts.glsl, generation/layered_noise/weights.glsl
//   units    heights without unit
//   source   Belaiche 2010, section 4.3.3
//   tested   tests/glsl/test_layered_noise.py, against NumPy
#include "generation/layered_noise/parts.glsl"
#include "generation/layered_noise/weights.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D shape;         //! input
uniform sampler2D tile;          //! input
uniform int tiles = 4;           //! slider(1, 64) Parts a side
uniform int octaves = 2;         //! slider(0, 8) Layers, the shape among them
uniform float persistence = 0.2; //! slider(0, 1) step(0.01) Weight of the first layer; each next
                                 //! layer has this share of it

float kernel(ivec2 texel) {
    ivec2 place = place_in_part(texel, textureSize(tile, 0), tiles);
    float weights = sum_of_weights(0, octaves, persistence);
    float finer = sum_of_weights(1, octaves, persistence);
    float details = texelFetch(tile, place, 0).r * finer;
    float total = details + texelFetch(shape, texel, 0).r * (weights - finer);
    return weights > 0.0 ? total / weights : 0.0;
}
