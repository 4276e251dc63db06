#version 330
// Two images over an area, divided by a line, or their difference; texels as in show_image.frag.
uniform sampler2D first;
uniform sampler2D second;
uniform ivec4 area;
uniform float split;  // share of the width; left of it is the first
uniform float gain;   // above 0: so many times the difference
out vec4 colour;
vec3 texel(sampler2D of, vec2 share) {
    ivec2 size = textureSize(of, 0);
    return texelFetch(of, clamp(ivec2(share * vec2(size)), ivec2(0), size - 1), 0).rgb;
}
void main() {
    vec2 share = (gl_FragCoord.xy - vec2(area.xy)) / vec2(area.zw);
    vec3 a = texel(first, share), b = texel(second, share);
    colour = vec4(gain > 0.0 ? gain * abs(a - b) : share.x < split ? a : b, 1.0);
}
