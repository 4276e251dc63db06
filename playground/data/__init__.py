"""Files in and out: elevations, vectors, models, pictures, films, sounds, live inputs.

None of it knows of OpenGL, of sketches, nor of colour encodings (`playground.shader.parameter`).
"""
