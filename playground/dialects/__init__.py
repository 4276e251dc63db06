"""Shaders of other tools: Shadertoy, ISF, glslViewer, Bonzomatic, KodeLife and more, run unchanged.

``table`` lists them and tells them apart; each reads a text as a technique. Needs the core's shader and
sketch. To delete it: this folder, tests/dialects, the sketches that tests/test_rooms.py names, and its line
in rooms.py.
"""
