// generation/circles/raw.glsl -- domes added to the terrain, one over each disc.
//
//   gives    height, for any terrain; not normalised
//   needs    generation/circles/dome.glsl
//   units    heights without unit
//   source   Belaiche 2010, section 1.3.7; named Lau 1993 there
//   tested   tests/glsl/test_marks.py, against a twin in NumPy
//
// Disc i has the middle c_i, the radius r_i and the height a_i:
//
//     h(p) += a_i dome(|p - c_i|^2 / r_i^2)   where |p - c_i| < r_i
//
// Outside every disc the terrain keeps its height to the last bit. A step is a disc; one run
// takes as many as are requested, in their order.
#include "generation/circles/dome.glsl"
#pragma kernel(output = "height:r32f", repeat = "discs", at_once = "discs")

uniform sampler2D disc;   //! input
uniform int discs = 200;  //! slider(0, 1000) How many
uniform int dome = 0;     //! menu("half a cosine", "half a sphere") Its shape: level at the rim,
                          //! or vertical

float kernel(ivec2 texel) {
    vec2 place = vec2(texel) * spacing / shorter_side(extent);
    int end = min(until, textureSize(disc, 0).x);
    float height = previous(texel);
    // anchor: add
    for (int which = iteration; which < end; which++) {
        vec4 one = texelFetch(disc, ivec2(which, 0), 0);
        float share = disc_share(place - one.xy, one.z);
        if (share < 1.0) height += one.w * dome_of_share(share, dome == 1);
    }
    // end: add
    return height;
}
