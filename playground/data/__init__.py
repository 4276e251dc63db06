"""Files in and out: elevations, vectors, models, pictures, films, sounds, live inputs.

It knows nothing of OpenGL, sketches or colour encodings (``playground.shader.parameter``). Needs nothing
but the base modules. Part of the core, so it stays.
"""
