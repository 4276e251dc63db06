#version 330
// An image over an area of the screen. Texels are fetched, not sampled, so that a bound sampler
// changes nothing; an image of another size is stretched.
uniform sampler2D picture;
uniform ivec4 area;
uniform bool grey;
out vec4 colour;
void main() {
    vec2 share = (gl_FragCoord.xy - vec2(area.xy)) / vec2(area.zw);
    ivec2 size = textureSize(picture, 0);
    vec4 texel = texelFetch(picture, clamp(ivec2(share * vec2(size)), ivec2(0), size - 1), 0);
    colour = vec4(grey ? texel.rrr : texel.rgb, 1.0);
}
