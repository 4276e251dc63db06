// One triangle over the whole picture, farther away than all terrain.

out vec2 place;
void main() {
    place = vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0;
    gl_Position = vec4(place, 1.0, 1.0);
}
