// A texel by its place, of what a sampler gives texel by texel, with 0 around it: llvmpipe looks up the
// level of texelFetch for each texel anew, and takes twice as long.
vec4 $fetch(sampler2D k_input, ivec2 k_place, int k_level) {
    return textureLod(k_input, (vec2(k_place) + 0.5) * $share, 0.0);
}
