"""Publishing: a picture or its data leaves as files, films, web pages, notebooks and shaders of other tools.

Needs the core alone: its ``addition`` and ``window`` are imported by a window only. To delete it: this
folder, tests/publish, its line in rooms.py and its exporter in pyproject.toml; ``course``, which needs it,
goes with it.
"""
