"""Broken pictures that a comparison must not let pass, and good ones that it must not refuse.

    rendering.toml     mutants that the engine draws: texts, parameters, wiring, camera
    rendering.py       a mutant and a sketch → the broken sketch
    finished.py        mutants that are made of the finished picture
    suite.py           every mutant of a shot, judged in every tier
    repeatability.py   the shot drawn again under conditions that must not matter, and judged

Each knows only those above it. Importing this opens nothing.
"""
