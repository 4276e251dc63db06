"""Image files in and out, and the colour encodings they use.

`files` moves pictures and values between disk and NumPy arrays; `colour` moves
numbers between encoded and linear sRGB. Neither knows of OpenGL, nor of land:
elevation files are `playground.terrain.elevation`.
"""
