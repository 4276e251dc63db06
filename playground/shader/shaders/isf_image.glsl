vec2 IMG_SIZE(sampler2D k_image) {
    return vec2(textureSize(k_image, 0));
}
vec4 IMG_NORM_PIXEL(sampler2D k_image, vec2 k_share) {
    return texture(k_image, k_share);
}
vec4 IMG_PIXEL(sampler2D k_image, vec2 k_texel) {
    return texture(k_image, k_texel / IMG_SIZE(k_image));
}
