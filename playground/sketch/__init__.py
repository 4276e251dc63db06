"""A sketch as a value: read from TOML, changed, saved.

A ``Sketch`` is frozen: a slider, a preset or ``--set`` makes a new one. Nothing here opens a window, a
context or a picture. Needs ``shader`` and ``data``. Part of the core: every other room stands on it, so it
stays.
"""
