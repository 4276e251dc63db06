// How many texels an input has, all of which have the size of this pass: read once.
uniform ivec2 size;
ivec2 k_own_size = size;
vec2 k_own_share = 1.0 / vec2(size);
ivec2 $size(sampler2D k_input, int k_level) {
    return k_level == 0 ? k_own_size : textureSize(k_input, k_level);
}
#define textureSize $size
