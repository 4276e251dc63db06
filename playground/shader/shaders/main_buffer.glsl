out vec4 k_frag_color;
void main() {
    vec4 k_picture = vec4(0.0);
    vec2 k_pixel = gl_FragCoord.xy + vec2($window);
    mainImage(k_picture, k_pixel);
    k_frag_color = k_picture;
}
