"""Plan and run a sketch on a context: passes, loops, staleness, iterations, the sandbox.

Knows no technique by name: the terrain lives in ``glsl/``.
"""
