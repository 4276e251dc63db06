"""The studio: a window with a live session, a folder a feature.

Needs the core. To delete it: this folder, tests/studio and its line in rooms.py; ``course`` and ``flight``,
which need it, go with it.
"""
