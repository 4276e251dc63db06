"""Image files in and out.

`files` moves pictures and values between disk and NumPy arrays, `endings` says by what
names. Neither knows of OpenGL, of colour encodings (`playground.sketch.colour`), nor of
land: elevation files are `playground.terrain.elevation`.
"""
