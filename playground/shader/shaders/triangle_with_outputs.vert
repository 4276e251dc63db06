$version
// One triangle that covers the whole target, and what the fragment shader reads of its vertices.
uniform vec4 $shares;
$declarations
void main() {
    vec2 k_corner = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 2.0;
    vec2 k_share = $shares.xy + k_corner * $shares.zw;  // 0..1 over the whole picture
    vec2 k_place = k_share * 2.0 - 1.0;             // -1..1
    gl_Position = vec4(k_corner * 2.0 - 1.0, 0.0, 1.0);
    $statements
}
