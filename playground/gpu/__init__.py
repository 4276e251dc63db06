"""OpenGL: contexts, the drivers that make a kernel runnable, programs, textures, timers.

No files and no window here. A context is handed in, never global.
"""
