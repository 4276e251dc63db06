#version 330
// A fragment for each block of texels in which some bit differs between two textures of one size:
// an occlusion query says whether there is one. Bits, so that NaN is NaN and 0 is not -0.
uniform sampler2D k_now;
uniform sampler2D k_before;
uniform int k_block;
out vec4 k_out;

void main() {
    ivec2 corner = ivec2(gl_FragCoord.xy) * k_block, last = textureSize(k_now, 0) - 1;
    ivec4 differ = ivec4(0);
    for (int y = 0; y < k_block; y++) {
        for (int x = 0; x < k_block; x++) {
            ivec2 texel = min(corner + ivec2(x, y), last);
            ivec4 now = floatBitsToInt(texelFetch(k_now, texel, 0));
            differ |= now ^ floatBitsToInt(texelFetch(k_before, texel, 0));
        }
    }
    if (differ == ivec4(0)) discard;
    k_out = vec4(1.0);
}
