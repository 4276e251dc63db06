"""From a sketch to textures: plan, run, cache; a sandbox and worker processes for what may hang or crash.

The core's only room with OpenGL. It knows no technique by name: the terrain lies in ``glsl/``.
Needs ``sketch``, ``shader``, ``data``. Part of the core: every other room stands on it, so it stays.
"""
