// A texel of level 0 as a sampler that takes the nearest finds it; outside, zeros, as of a fetch.
vec4 $fetch(sampler2D k_input, ivec2 k_place, int k_level) {
    if (k_level != 0) return texelFetch(k_input, k_place, k_level);
    ivec2 k_texels = $texels;
    vec4 k_found = textureLod(k_input, (vec2(k_place) + 0.5) * $share, 0.0);
    return all(lessThan(uvec2(k_place), uvec2(k_texels))) ? k_found : vec4(0.0);
}
#define texelFetch $fetch
