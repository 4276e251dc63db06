#version 330
// The texels of a lattice, which lie close together, where they belong; zeros between.
uniform sampler2D k_picture;
uniform int k_shift;
out vec4 k_out;

void main() {
    ivec2 texel = ivec2(gl_FragCoord.xy);
    bool known = ((texel.x | texel.y) & ((1 << k_shift) - 1)) == 0;
    k_out = known ? texelFetch(k_picture, texel >> k_shift, 0) : vec4(0.0);
}
