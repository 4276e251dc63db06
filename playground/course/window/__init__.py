"""Lessons in the live window: a panel of text next to the picture, which is the live view itself.

Of the reader, without a window:

reader        which page and figure are shown, questions and answers; ``progress`` remembers it
figure_view   a figure in the session's view; ``bugs`` broken shaders, ``tasks`` exercises and their scores

Of the panel, by imgui: ``page`` draws texts that are laid out by ``typeset``, ``formulas`` among them; each
kind of block has a function in ``blocks``, which ``panel`` calls.
"""
