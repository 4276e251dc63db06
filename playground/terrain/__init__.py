"""The CPU side of terrain: what a shader cannot do, such as reading elevation files.

Nothing here opens a context or a window. Arrays have row 0 in the south and
lengths are metres, as everywhere in the engine.
"""
