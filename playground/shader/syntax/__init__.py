"""GLSL as a syntax tree: tokens, preprocessor, grammar, symbols, types.

``parse`` never raises: what cannot be read is an error with its token, and the rest is still there.
"""
