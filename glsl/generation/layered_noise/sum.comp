// generation/layered_noise/sum.comp -- the layers added up, along four columns of texels at once.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/layered_noise/piece.glsl
//   units    heights without unit, 0..1
//   source   see generation/layered_noise/piece.glsl
//   tested   tests/glsl/test_layered_noise.py and tests/glsl/test_fast_variants.py, against the
//            kernel next to it
//   agrees   but for roundings, as the passes of sum.fast.toml
//
// A thread goes along 64 rows of four columns, from one piece to the next.
#pragma compute(where = "fours = (size.x + 3) // 4", local = "16, 1", \
                groups = "(fours + 15) // 16, (size.y + 63) // 64", \
                buffers = "height:vec4:fours * size.y; bounds:uint:2", aligned = "16", \
                overwrites = "height", agrees = "1e-6")

uniform int frequency = 4;       //! log_slider(1, 1024) As in the technique
uniform int octaves = 2;         //! slider(0, 8) As in the technique
uniform float persistence = 0.2; //! slider(0, 1) step(0.01) As in the technique
uniform uint seed = 7u;          //! slider(0, 9999) As in the technique
uniform int interpolation = 1;   //! menu("linear", "smooth") As in the technique
uniform int random_layers = 0;   //! menu("one", "independent") As in the technique
uniform int overflow = 0;        //! menu("divide", "clamp", "wrap") As in the technique
uniform int layer = 0;           //! slider(0, 8) As in the technique
uniform int left_out = 0;        //! slider(0, 8) As in the technique
uniform int tiles = 1;           //! slider(1, 64) As in the technique
uniform int seams = 1;           //! menu("removed", "left") As in the technique

#include "generation/layered_noise/piece.glsl"

void main() {
    make_fours(int(gl_GlobalInvocationID.x), int(gl_WorkGroupID.y) * ROWS, false);
}
