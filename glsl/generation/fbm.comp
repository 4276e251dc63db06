// generation/fbm.comp -- fractional Brownian motion along columns of texels, and normalised.
//
//   gives    height
//   needs    generation/fbm/salt.glsl, generation/gradient_noise/fours.glsl,
//            generation/normalise/fours.glsl
//   units    as the technique
//   source   as the technique
//   tested   tests/glsl/test_fast_variants.py, against the technique's own passes
//   agrees   as generation/gradient_noise/sum.comp does, over the range of its heights
//
// The first stage makes heights and tells their range, the second stretches them where they lie.
#pragma compute(stages = "0, 1", local = "16, 1", \
                where = "fours = (size.x + 3) // 4; all_fours = fours * size.y", \
                groups = "all_fours // 1024 + 1 if iteration else (fours + 15) // 16, \
                          1 if iteration else (size.y + 31) // 32", \
                buffers = "height:vec4:all_fours; bounds:uint:2", aligned = "16", \
                overwrites = "height", agrees = "1e-4")

uniform float hurst = 0.8;       //! slider(0, 1) step(0.01) As in the technique
uniform int octaves = 8;         //! slider(0, 16) As in the technique
uniform float frequency = 4.0;   //! log_slider(0.25, 1024) As in the technique
uniform float lacunarity = 2.0;  //! slider(1.1, 4) step(0.05) As in the technique
uniform uint seed = 7u;          //! slider(0, 9999) As in the technique
uniform int normalise = 2;       //! menu("none", "max", "minmax") As in the technique

// What the technique leaves as it is.
const int basis = 0;
const int shape = 0;
const float warp = 0.4;
#include "generation/fbm/salt.glsl"
#include "generation/gradient_noise/fours.glsl"
#include "generation/normalise/fours.glsl"

const int MAKE = 0, STRETCH = 1;

void main() {
    int four = int(gl_GlobalInvocationID.x);
    if (stage == MAKE) {
        make_fours(four, int(gl_WorkGroupID.y) * ROWS, pow(lacunarity, -hurst), seed + FBM_SALT,
                   normalise != 0);
    }
    if (stage == STRETCH) stretch_fours(normalise);
}
