// generation/gradient_noise/sum.comp -- hills of gradient noise, along columns of texels.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/gradient_noise/{fours,parameters/octaves,salt}.glsl
//   units    heights without unit, as in the kernel next to it
//   source   see noise/columns.glsl
//   tested   tests/glsl/test_gradient_noise.py and tests/glsl/test_fast_variants.py,
//            against the kernel next to it
//   agrees   best at a low gain: both round places, in another order
#pragma compute(where = "fours = (size.x + 3) // 4", local = "16, 1", \
                groups = "(fours + 15) // 16, (size.y + 31) // 32", \
                buffers = "height:vec4:fours * size.y; bounds:uint:2", aligned = "16", \
                overwrites = "height", agrees = "1e-4")

#include "generation/gradient_noise/parameters/octaves.glsl"
#include "generation/gradient_noise/fours.glsl"
#include "generation/gradient_noise/salt.glsl"

void main() {
    make_fours(int(gl_GlobalInvocationID.x), int(gl_WorkGroupID.y) * ROWS, gain,
               seed + GRADIENT_NOISE_SALT, false);
}
