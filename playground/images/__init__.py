"""Image files in and out.

`files` moves pictures and values between disk and NumPy arrays, `image_formats` writes a picture in
the format of its name's ending, `extensions` lists those. None knows of OpenGL, of
colour encodings (`playground.sketch.colour`), nor of terrain: elevation files are
`playground.terrain.elevation`.
"""
