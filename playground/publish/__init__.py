"""Publishing: a picture or its data leaves as files, films, web pages, notebooks and shaders of other tools.

Needs the core. To delete it: this folder, tests/publish and its line in rooms.py.
"""
