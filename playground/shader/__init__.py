"""GLSL as text: read, check, translate, assemble, explain.

No OpenGL, no window, no picture. Needs nothing but the base modules. Part of the core, so it stays; what
reads other tools' shaders is a room of its own (``dialects``), which ``dialect`` asks for.
"""
