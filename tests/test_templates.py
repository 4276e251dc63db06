"""The sketch that `playground new` makes: its first picture shows all of the terrain, and little else."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from playground.engine.camera import look
from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.sketch.load import load
from playground.sketch.model import DEFAULT_PICTURE
from playground.sketch.templates import make_sketch


def test_the_first_view_of_a_new_sketch_shows_all_of_the_terrain(engine: Engine, tmp_path: Path) -> None:
    sketch = load(make_sketch(tmp_path / "hills"))
    extent, relief = sketch.terrain.extent, sketch.terrain.relief
    assert extent is not None and relief is not None
    height = engine.read(sketch, "height") * relief
    rows, columns = height.shape
    east, north = np.linspace(0, extent[0], columns), np.linspace(0, extent[1], rows)
    grid = np.stack([*np.meshgrid(east, north), height], axis=-1)
    foot = -values_of(sketch)["view.land.skirt"] * extent[0]  # type: ignore[operator]
    corners = [[x, y, foot] for x in (0, extent[0]) for y in (0, extent[1])]
    places = np.concatenate([grid.reshape(-1, 3), corners]).astype(float)
    matrix = look(sketch.camera, extent, relief, DEFAULT_PICTURE).clip_from_world.astype(float)
    clip = np.concatenate([places, np.ones((len(places), 1))], axis=1) @ matrix.T
    across, up = (clip[:, axis] / clip[:, 3] for axis in (0, 1))
    assert np.abs(across).max() < 0.95 and np.abs(up).max() < 0.95, "nothing is cut, its cut front included"
    assert up.max() > 0.7 and np.abs(across).max() > 0.8, "it fills most of the picture"
