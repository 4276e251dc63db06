// The same where only texels at multiples of a stride are known: these lie close together, and
// every other is 0.
uniform sampler2D k_previous_$output;
$type $previous(ivec2 k_texel) {
    k_texel = clamp(k_texel, ivec2(0), size - 1);
    bool k_known = ((k_texel.x | k_texel.y) & ((1 << k_previous_shift) - 1)) == 0;
    ivec2 k_place = min(k_texel >> k_previous_shift, textureSize(k_previous_$output, 0) - 1);
    return k_known ? texelFetch(k_previous_$output, k_place, 0)$swizzle : $type(0.0);
}
