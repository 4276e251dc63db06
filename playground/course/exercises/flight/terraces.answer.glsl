// generation/endless/sum.glsl -- the height of a part and around it: shape, and detail put on.
//
//   gives    height, 0..1
//   needs    terrain/parts.glsl, noise/periodic.glsl; a shape and a detail
//   units    heights without unit
//   source   Belaiche 2010, section 5.6
//   tested   tests/glsl/test_endless.py, against a twin in float64; borders to the last bit
//
// Weights sum to 1 where the shape is highest, so nothing leaves 0..1 and nothing needs
// normalising, which would bring each part to a range of its own. Low terrain is given less of the
// detail: one component then does not show that it repeats.
#include "noise/periodic.glsl"
#include "terrain/parts.glsl"
#pragma kernel(output = "height:r32f")

uniform sampler2D shape;           //! input
uniform sampler2D detail;          //! input
uniform ivec2 part = ivec2(0);     //! parts("east", "north") Which part of the terrain, counted
                                   //! east and north
uniform int apron = 0;             //! slider(0, 1024) unit("texels") Of the neighbours, so much
                                   //! around the part
uniform float rough = 0.45;        //! slider(0, 1) step(0.01) Share of the detail in the highest
                                   //! terrain
uniform float valleys = 0.15;      //! slider(0, 1) step(0.01) Of that share, what the lowest
                                   //! terrain has
uniform float peaks = 0.7;         //! slider(0, 1) step(0.01) How much the shape is bent: wide
                                   //! valleys and steep mountains

float kernel(ivec2 texel) {
    float low = texelFetch(shape, texel, 0).r;
    low = floor(low * 8.0) / 8.0;
    ivec2 place = lattice_wrapped(node_of(texel, part, apron, size), textureSize(detail, 0));
    float fine = texelFetch(detail, place, 0).r;
    float bent = low + (low * low - low) * peaks;
    return (1.0 - rough) * bent + rough * (valleys + (1.0 - valleys) * bent) * fine;
}
