"""Verification: is it still right (check, shots, mutants), what breaks it (reduce), how fast is it (bench).

Needs the core. To delete it: this folder, tests/verify, its line in rooms.py and the plugin's in
pyproject.toml (``pytest11``, ``-p`` of ``addopts``, ``shots``); ``lsp``, which needs it, goes with it.
"""
