"""Lessons on terrain, with figures, exercises and grading: in the window, as a book, notebooks and talks.

A lesson is Markdown with TOML blocks (``texts/``), read into blocks (``model``), which every medium shows.
Reading needs no OpenGL; what draws receives an engine. The room builds on the core, the window (``studio``)
and publishing (``publish``), and nothing imports it: to remove it, delete this folder, ``tests/course`` and
its line in ``playground.rooms``.
"""
