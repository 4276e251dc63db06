"""One triangle that covers a whole target: the vertex shader of all that computes fragments."""

from __future__ import annotations

from playground.gpu.own_shaders import own_shader

TRIANGLE = own_shader("triangle.vert")
"""Computed from the vertices' numbers alone: draw three vertices without a buffer."""
