// The size of each input, which is that of the pass: known before any texture is asked for it.
uniform ivec2 size;
ivec2 k_own_size = size;
vec2 $share = 1.0 / vec2(size);
ivec2 $size(sampler2D k_input, int k_level) {
    return k_level == 0 ? k_own_size : textureSize(k_input, k_level);
}
#define textureSize $size
