"""The live window: the only place with a window, keys and a wall clock.

Reading order: ``edits`` (what a person changed by hand), ``session`` (the sketch, its
last good picture, its errors; no window), ``watch`` (files), then ``window``,
``gesture``, ``panel``, ``overlay`` and ``app``, which ties them together.
"""
