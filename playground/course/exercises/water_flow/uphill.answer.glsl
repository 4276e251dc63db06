// water/directions.glsl -- which neighbour each texel drains to: the steepest way down.
//
//   gives    receiver, the number of the texel that a texel drains to; its own on the edges, which
//            are outlets, and in pits
//   needs    noise/hash.glsl, water/texels.glsl
//   units    numbers of texels, as water/texels.glsl counts them
//   source   O'Callaghan and Mark 1984, "The extraction of drainage networks from digital
//            elevation data": eight directions; Fairfield and Leymarie 1991, "Drainage networks
//            from grid digital elevation models": the randomised choice (Rho8)
//   tested   tests/glsl/test_directions.py, against NumPy, turned and mirrored
//
// With eight directions an even slope drains in parallel straight lines. Each slope times a random
// number below 1 lets them wander; what is chosen is still lower, so no way leads up.
#include "noise/hash.glsl"
#include "water/texels.glsl"
#pragma kernel(output = "receiver:r32f", \
               accepts = "n up to 4096, m up to 4096")

uniform sampler2D height;         //! input
uniform float randomness = 0.0;   //! slider(0, 1) step(0.01) How far the ways wander; 0 is the
                                  //! steepest neighbour
uniform uint seed = 1u;           //! slider(0, 9999) Which way they wander

const uint SALT = 0xa239a0c1u;  // CRC-32 of "water/directions"

float kernel(ivec2 texel) {
    float own = number_of(texel, size);
    if (on_edge(texel, size)) return own;
    float here = texelFetch(height, texel, 0).r;
    float steepest = 1e30;
    float found = own;
    for (int k = 0; k < NEIGHBOURS; k++) {
        ivec2 step_to = neighbour_of(k);
        ivec2 there = texel + step_to;
        // anchor: steepest
        float drop = (here - texelFetch(height, there, 0).r) / length(vec2(step_to) * spacing);
        // end: steepest
        if (randomness > 0.0) {
            drop *= 1.0 - randomness * random(3 * texel + step_to + 1, seed + SALT);
        }
        if (drop > 0.0 && drop < steepest) {
            steepest = drop;
            found = number_of(there, size);
        }
    }
    return found;
}
