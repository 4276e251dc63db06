// A texel of the iteration before, from its texture.
uniform sampler2D k_previous_$output;
$type $previous(ivec2 k_texel) {
    ivec2 k_last = textureSize(k_previous_$output, 0) - 1;
    return texelFetch(k_previous_$output, clamp(k_texel, ivec2(0), k_last), 0)$swizzle;
}
