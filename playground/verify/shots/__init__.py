"""Screenshot tests: compare the pictures that sketches promise with their references, by hand or in pytest.

``suite`` draws a sketch's shots, ``judge`` gives each a word of ``verdicts``; ``results`` are records in a
folder, which ``report`` and ``review`` show, and of which ``accept`` makes references. ``plugin`` is what
pytest loads. ``mutants/`` breaks images on purpose, to test the comparison. Importing this opens nothing.
"""
