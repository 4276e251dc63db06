"""The shipped sketches as parameters of tests: a few of every kind are for every day, the others are slow."""

from __future__ import annotations

import pytest

from playground.sketch.find import shipped_sketches

FEW = (
    "contours_map",  # a map
    "delaunay",  # a mesh of its own
    "diamond_square",  # sizes that fit a rule, steps
    "flood",  # a state, and texts written anew
    "from_elsewhere",  # passes of other tools
    "geomipmap",  # levels of detail
    "jacksboro",  # a land that was measured
    "life",  # feedback
    "splat",  # images
    "sun_flight",  # keyframes
)
SHIPPED = [
    pytest.param(name, id=name, marks=() if name in FEW else pytest.mark.slow) for name in shipped_sketches()
]
