"""Dunes: lee sides at the angle of repose, sand on low and flat ground alone."""

from __future__ import annotations

import numpy as np
import pytest

from ..sketch_texts import passes

PLANE = """#pragma kernel(output = "height:r32f")
uniform float rise = 0.0; //! slider(0, 1) To the north
float kernel(ivec2 texel) { return rise * float(texel.y) / float(size.y - 1); }
"""
SIDE, EXTENT, RELIEF = 513, 2000.0, 500.0
REPOSE = 0.65
"""The slope of 33 degrees at which dry sand slides."""


@pytest.fixture
def dunes(engine, make_sketch):
    """Give ``dunes(rise, **parameters)``: metres of sand, and the fraction of the ground where it lies."""

    def read(rise=0.0, **values):
        text = ", ".join(f"{name} = {value}" for name, value in values.items())
        plane = ("./plane", f"set = {{ rise = {rise} }}")
        made = passes(
            plane=plane, blown=("generation/dunes", 'inputs = { height = "plane" }', f"set = {{ {text} }}")
        )
        sketch = make_sketch(made, size=SIDE, extent=EXTENT, relief=RELIEF, plane=PLANE)
        bare = rise * np.linspace(0, 1, SIDE)[:, None]
        height = engine.read(sketch, "blown:height").astype(np.float64)
        return RELIEF * (height - bare), engine.read(sketch, "blown:sand").astype(np.float64)

    return read


def test_dune_lee_falls_at_repose_and_windward_side_is_gentler(dunes):
    """With wind from the west crests lie from south to north, and the steep sides look east."""
    sand, lies = dunes(wind=270.0, bends=0.0, between=400.0, tallest=40.0)
    assert lies.min() == 1 and sand.min() > -1e-3 and sand.max() < 40
    slope = np.diff(sand, axis=1) * (SIDE - 1) / EXTENT
    # Of large dunes 0.75 of the angle of repose, of small ones a fifth, and of their coming and going 0.04.
    assert -REPOSE * 1.02 < slope.min() < -0.5 * REPOSE
    assert slope.max() < 0.5 * REPOSE


def test_dunes_that_cannot_be_so_tall_are_lower_and_no_steeper(dunes):
    """200 m on 150 m from crest to crest: at the angle of repose over half of that, 0.75 of 49 m."""
    sand, _ = dunes(wind=270.0, bends=0.0, between=150.0, tallest=200.0)
    slope = np.diff(sand, axis=1) * (SIDE - 1) / EXTENT
    assert -REPOSE * 1.02 < slope.min() < -0.5 * REPOSE
    assert 0.5 * 0.75 * REPOSE * 75 < sand.max() <= REPOSE * 75


def test_no_sand_on_steep_or_high_ground(dunes):
    sand, lies = dunes(rise=1.0, steep=2.0, below=[100.0, 200.0])
    row = (SIDE - 1) // 5  # 100 m, and 200 m at twice the row
    assert lies[:row].min() > 0.9 and sand[:row].max() > 5
    assert np.abs(sand[2 * row + 1 :]).max() < 1e-3
    assert np.abs(dunes(rise=1.0, steep=0.2, below=[500.0, 900.0])[0]).max() < 1e-3
