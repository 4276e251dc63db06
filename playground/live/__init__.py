"""The live window, its keys and its wall clock.

``app`` opens a sketch in a ``window`` and draws its frames; ``panel`` is made from the sketch's
annotations, one row a parameter by ``widgets``; ``keys`` is the table of keys. Importing this opens
nothing; a session without a window is in ``workbench``.
"""
