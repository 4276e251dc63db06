"""Image files in and out.

`files` moves pictures and values between disk and NumPy arrays, `pictures` writes a picture in
the format that its name asks for, `endings` says by what names. None knows of OpenGL, of
colour encodings (`playground.sketch.colour`), nor of terrain: elevation files are
`playground.terrain.elevation`.
"""
