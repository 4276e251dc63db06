"""A sketch as a value: read, changed, saved.

Nothing here opens a window, a context or a picture. A ``Sketch`` is a frozen
value: a slider, a preset or ``--set`` makes a new one.
"""
