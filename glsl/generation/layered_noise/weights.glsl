// generation/layered_noise/weights.glsl -- the sum of the layers' weights.
//
//   gives    sum_of_weights
//   needs    nothing: pure functions, no uniforms, no textures
//   units    weights without unit
//   source   Belaiche 2010, section 1.3.9
//   tested   tests/glsl/test_layered_noise.py, against NumPy
#ifndef GENERATION_LAYERED_NOISE_WEIGHTS
#define GENERATION_LAYERED_NOISE_WEIGHTS

// Of layers 0, 1, .. octaves - 1 with the weights persistence^(k+1), without the first so many.
float sum_of_weights(int left_out, int octaves, float persistence) {
    float weight = 1.0;
    float total = 0.0;
    // Always the most there are: a loop of fixed length costs nothing to speak of, others do.
    for (int k = 0; k < 8; k++) {
        weight *= persistence;
        total += k >= left_out && k < octaves ? weight : 0.0;
    }
    return total;
}
#endif
