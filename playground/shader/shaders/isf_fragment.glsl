#define vv_FragNormCoord isf_FragNormCoord
#define IMG_THIS_PIXEL(k_image) texture(k_image, isf_FragNormCoord)
#define IMG_THIS_NORM_PIXEL(k_image) texture(k_image, isf_FragNormCoord)
vec4 IMG_NORM_PIXEL(sampler2D k_image, vec2 k_share, float k_bias) {
    return texture(k_image, k_share, k_bias);
}
vec4 IMG_PIXEL(sampler2D k_image, vec2 k_texel, float k_bias) {
    return texture(k_image, k_texel / IMG_SIZE(k_image), k_bias);
}
