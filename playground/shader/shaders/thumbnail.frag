#version 330
// Few texels of a texture, evenly over it.
uniform sampler2D shown;
uniform float side;
out vec4 value;
void main() {
    ivec2 size = textureSize(shown, 0);
    value = texelFetch(shown, min(ivec2(gl_FragCoord.xy / side * vec2(size)), size - 1), 0);
}
