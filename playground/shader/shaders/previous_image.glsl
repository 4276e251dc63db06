// The same from the image that is written in place.
$type $previous(ivec2 k_texel) {
    return imageLoad(k_image_$output, clamp(k_texel, ivec2(0), size - 1))$swizzle;
}
