// texturing/vectors/over.glsl -- a colour over another, as far as a mask covers it.
//
//   gives    colour, linear light
//   needs    maths/drape.glsl, maths/land.glsl; a colour and a mask, each of any size
//   units    mask 0..1
//   source   Porter and Duff 1984, "Compositing Digital Images", "over" with an opaque ground
//   tested   tests/glsl/test_vectors.py: none, half and all of it, and means of a finer mask
#include "maths/drape.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D colour;  //! input("linear", "mipmap")
uniform sampler2D mask;    //! input("linear", "mipmap")

uniform vec3 tint = vec3(0.60, 0.03, 0.02);  //! colour What is laid over the ground
uniform float strength = 1.0;  //! slider(0, 1) step(0.01) How much it hides of the ground

vec4 of_place(sampler2D field, ivec2 texel) {
    ivec2 texels = textureSize(field, 0);
    if (texels == size) return texelFetch(field, texel, 0);
    vec2 shrunk = vec2(texels) / vec2(size);
    float level = max(log2(max(shrunk.x, shrunk.y)), 0.0);
    return textureLod(field, drape_uv(share_of_texel(texel, size), texels), level);
}

vec4 kernel(ivec2 texel) {
    float share = strength * clamp(of_place(mask, texel).r, 0.0, 1.0);
    return vec4(mix(of_place(colour, texel).rgb, tint, share), 1.0);
}
