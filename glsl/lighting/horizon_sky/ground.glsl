// lighting/horizon_sky/ground.glsl -- the mean colour of the ground under a texel.
//
//   gives    ground_under
//   needs    maths/drape.glsl, maths/land.glsl; the texture comes as an argument, no uniform of
//            its own
//   units    linear colour, 0..1
//   source   C(p) in Belaiche 2010, section 3.4
//   tested   tests/glsl/test_sky.py, by a colour finer than the light
#ifndef LIGHTING_HORIZON_SKY_GROUND
#define LIGHTING_HORIZON_SKY_GROUND
#include "maths/drape.glsl"
#include "maths/land.glsl"

// By the level of detail whose texels are as large as the light's; `unwired` where no colour is
// wired.
vec3 ground_under(bool wired, sampler2D colour, ivec2 texel, ivec2 light, vec3 unwired) {
    if (!wired) return clamp(unwired, 0.0, 1.0);
    ivec2 texels = textureSize(colour, 0);
    vec2 each = vec2(texels) / vec2(light);
    float level = log2(max(max(each.x, each.y), 1.0));
    vec3 mean = textureLod(colour, drape_uv(share_of_texel(texel, light), texels), level).rgb;
    return clamp(mean, 0.0, 1.0);
}
#endif
