// texturing/drape/laid.glsl -- a texture of the whole terrain at another size, corners on corners.
//
//   gives    colour, linear light
//   needs    maths/drape.glsl, maths/land.glsl; a colour of any size
//   units    none
//   source   Belaiche 2010, section 2.2
//   tested   tests/glsl/test_texturing_drape.py: corners, the same bits at one size, means
#include "maths/drape.glsl"
#include "maths/land.glsl"
#pragma kernel(output = "colour:rgba16f")

uniform sampler2D colour;  //! input("linear", "mipmap")

vec4 kernel(ivec2 texel) {
    ivec2 texels = textureSize(colour, 0);
    if (texels == size) return vec4(texelFetch(colour, texel, 0).rgb, 1.0);
    vec2 shrunk = vec2(texels) / vec2(size);
    float level = max(log2(max(shrunk.x, shrunk.y)), 0.0);
    return vec4(textureLod(colour, drape_uv(share_of_texel(texel, size), texels), level).rgb, 1.0);
}
