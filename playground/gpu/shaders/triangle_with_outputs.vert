$version
// One triangle that covers the whole target, and what the fragment shader reads of its vertices.
$declarations
void main() {
    vec2 k_place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;  // -1..1 over the target
    vec2 k_share = k_place * 0.5 + 0.5;                                  // 0..1
    gl_Position = vec4(k_place, 0.0, 1.0);
    $statements
}
