"""One triangle that covers a whole target: the vertex shader of whatever works fragment by fragment."""

from __future__ import annotations

from playground.gpu.own_shaders import own_shader

TRIANGLE = own_shader("triangle.vert")
"""Made of the vertices' numbers alone: draw three vertices, of no buffer."""
