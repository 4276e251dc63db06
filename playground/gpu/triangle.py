"""One triangle that covers a whole target: the vertex shader of whatever works fragment by fragment."""

from __future__ import annotations

TRIANGLE = """#version 330
void main() { gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0); }
"""
"""Made of the vertices' numbers alone: draw three vertices, of no buffer."""
