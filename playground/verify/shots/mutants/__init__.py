"""Broken pictures that a comparison must not let pass, and good ones that it must not refuse.

    model.py         a mutant: its name, and one message, what a person would have broken
    rendering.toml   mutants that the engine draws: texts, parameters, wiring, camera
    render_mutants.py    that table, read
    breaking.py      a mutant and a sketch → the broken sketch
    image_mutants.py    mutants that are made of the finished picture
    tiers.py, suite.py    every mutant of a shot, judged in every tier
    harmless.py      conditions under which a shot must look the same
    repeatability.py    the shot drawn under them, in processes of their own, and judged

Each knows only those above it. Importing this opens nothing.
"""
