"""Text and numbers only: sketches, techniques, kernels' headers, includes, expressions.

Nothing here opens a window, a context or an image. A ``Sketch`` is a frozen
value: a slider, a preset or ``--set`` makes a new one.
"""
