#version 330
// The same for versions of GLSL that do not number vertices: corners in clip space from a buffer.
attribute vec2 $corner;
void main() {
    gl_Position = vec4($corner, 0.0, 1.0);
}
