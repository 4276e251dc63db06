// generation/layered_noise.comp -- layered noise along columns of texels, and normalised.
//
//   gives    height
//   needs    generation/layered_noise/piece.glsl, generation/normalise/fours.glsl
//   units    as the technique
//   source   as the technique
//   tested   tests/glsl/test_fast_variants.py, against the technique's own passes
//   agrees   as generation/layered_noise/sum.comp does, over the range of its heights
//
// The first stage makes heights and tells their range, the second stretches them where they lie.
#pragma compute(stages = "0, 1", local = "16, 1", \
                where = "fours = (size.x + 3) // 4; all_fours = fours * size.y", \
                groups = "all_fours // 1024 + 1 if iteration else (fours + 15) // 16, \
                          1 if iteration else (size.y + 63) // 64", \
                buffers = "height:vec4:all_fours; bounds:uint:2", aligned = "16", \
                overwrites = "height", agrees = "1e-5")

uniform int frequency = 4;       //! log_slider(1, 1024) As in the technique
uniform int octaves = 2;         //! slider(0, 8) As in the technique
uniform float persistence = 0.2; //! slider(0, 1) step(0.01) As in the technique
uniform uint seed = 7u;          //! slider(0, 9999) As in the technique
uniform int interpolation = 1;   //! menu("linear", "smooth") As in the technique
uniform int random_layers = 0;   //! menu("one", "independent") As in the technique
uniform int overflow = 0;        //! menu("divide", "clamp", "wrap") As in the technique
uniform int layer = 0;           //! slider(0, 8) As in the technique
uniform int normalise = 2;       //! menu("none", "max", "minmax") As in the technique

// What the technique leaves as it is.
const int left_out = 0;
const int tiles = 1;
const int seams = 1;
#include "generation/layered_noise/piece.glsl"
#include "generation/normalise/fours.glsl"

const int MAKE = 0, STRETCH = 1;

void main() {
    int four = int(gl_GlobalInvocationID.x);
    if (stage == MAKE) make_fours(four, int(gl_WorkGroupID.y) * ROWS, normalise != 0);
    if (stage == STRETCH) stretch_fours(normalise);
}
