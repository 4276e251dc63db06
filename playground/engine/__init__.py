"""From a sketch to textures: plan, run, cache, sandbox.

Knows no technique by name: the terrain lives in ``glsl/``.
"""
