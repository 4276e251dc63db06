"""Comparing the pictures that sketches promise with their references, by hand or in pytest.

    compare.py      two arrays → a verdict, how much, how many, where
    references.py   where references live; reading, writing, finding those that nothing uses
    suite.py        sketches → cases → frames → outcomes
    studio.py       a child process with the software renderer, which takes the pictures
    plugin.py       pytest: options, the ``shots`` fixture, what a failure prints

Each knows only those above it. Importing this opens nothing.
"""
