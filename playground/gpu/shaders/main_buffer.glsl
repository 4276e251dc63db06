out vec4 k_frag_color;
void main() {
    vec4 k_picture = vec4(0.0, 0.0, 0.0, 1.0);
    mainImage(k_picture, gl_FragCoord.xy + vec2($window));
    k_frag_color = k_picture;
}
