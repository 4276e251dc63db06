// Texels of an input that may be unwired: what replaces it has one texel, and outside of that one
// OpenGL gives 0.
uniform bool $unwired;
vec4 $fetch(sampler2D k_input, ivec2 k_place, int k_level) {
    bool k_single = $unwired && textureSize(k_input, k_level) == ivec2(1);
    return texelFetch(k_input, k_single ? ivec2(0) : k_place, k_level);
}
vec4 $fetch_offset(sampler2D k_input, ivec2 k_place, int k_level, ivec2 k_offset) {
    return $fetch(k_input, k_place + k_offset, k_level);
}
