// The same of an input that may be unwired: what replaces it has one texel, for every place.
vec4 $fetch_unwired(sampler2D k_input, ivec2 k_place, int k_level) {
    bool k_single = $unwired && textureSize(k_input, 0) == ivec2(1);
    return $fetch(k_input, k_single ? ivec2(0) : k_place, 0);
}
