#version 330
// One triangle that covers the whole target, and the place of each fragment on it, in texels.
uniform ivec2 size;
noperspective out vec2 k_place_at;
void main() {
    vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
    k_place_at = 2.0 * corner * vec2(size);
    gl_Position = vec4(corner * 4.0 - 1.0, 0.0, 1.0);
}
