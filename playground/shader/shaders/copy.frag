#version 330
// A texture in another size, nearest texel for nearest.
uniform sampler2D k_picture;
uniform ivec2 k_size;
out vec4 k_out;

void main() {
    ivec2 whole = textureSize(k_picture, 0);
    ivec2 texel = ivec2(gl_FragCoord.xy / vec2(k_size) * vec2(whole));
    k_out = texelFetch(k_picture, min(texel, whole - 1), 0);
}
