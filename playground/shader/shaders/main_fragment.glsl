void main() {
    ivec2 k_texel = ivec2(gl_FragCoord.xy)$shift;
    $call
}
