"""Verification: is it still right (check, shots, mutants), what breaks it (reduce), how fast is it (bench).

Needs the core. To delete it: this folder, tests/verify and its line in rooms.py.
"""
