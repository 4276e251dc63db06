// clouds/field/cloud.glsl -- clouds from above: how thick each is, and what it leaves of the beam.
//
//   gives    cloud: thickness as a share of the thickest, 0..1; what wears it away; its round
//            heaps; in alpha what is left of the sun's beam
//   needs    clouds/layer_form.glsl; a shape by clouds/field/shape, an edge by clouds/field/edge
//   units    shares 0..1
//   source   Beer and Lambert, with the depths of clouds/layer_form.glsl
//   tested   tests/glsl/test_clouds.py: the clouds of each cover leave what the cover leaves
//
// The beam is taken through as much cloud as there is straight up, whatever the sun's elevation:
// what a cover leaves of it does not depend on that either.
#include "clouds/layer_form.glsl"
#pragma kernel(output = "cloud:rgba16f")

uniform sampler2D shape;  //! input
uniform sampler2D edge;   //! input

vec4 kernel(ivec2 texel) {
    vec4 found = texelFetch(shape, min(texel, textureSize(shape, 0) - 1), 0);
    float thick = thickness_of(found.r, texelFetch(edge, ivec2(0), 0).r);
    return vec4(thick, found.g, found.b, exp(-depth_straight_up(thick)));
}
