"""GLSL as text: read, check, translate, assemble, explain. No OpenGL, no window, no picture."""
