"""Plan and run a sketch on a context: passes, loops, staleness, iterations, the sandbox process.

Knows no technique by name: the terrain lives in ``glsl/``.
"""
