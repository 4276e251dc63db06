"""Lessons in the live window: a panel of text next to the picture, which is the live view itself.

Markdown becomes runs of one style, runs are broken into lines, lines are drawn by ``prose``; each kind of
block has a function that ``panel`` calls. A reader without a window is in ``workbench.lesson``.
"""
