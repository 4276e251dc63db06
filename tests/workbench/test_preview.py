"""Previews: fewer samples and vertices, where nobody set more, and never what is saved."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.sketch.load import load
from playground.sketch.model import Sketch
from playground.workbench.preview import GRID, as_preview

SKETCH = """format = 1
size = 129
[[pass]]
name = "height"
use = "generation/diamond_square"
[view]
use = "view/terrain"
"""


@pytest.fixture
def terrain(tmp_path: Path) -> Sketch:
    (tmp_path / "terrain.toml").write_text(SKETCH, encoding="utf-8")
    return load(tmp_path / "terrain.toml")


def test_it_has_one_sample_and_a_coarser_mesh(terrain: Sketch):
    chosen = as_preview(terrain)
    assert chosen.samples == 1 and values_of(chosen)["view.land.grid"] == GRID
    assert values_of(chosen) == values_of(terrain) | {"view.land.grid": GRID}
    assert chosen.size == terrain.size


def test_few_pixels_that_are_enlarged_keep_their_samples(terrain: Sketch):
    assert as_preview(terrain, (600, 400), (300, 200)).samples == 1
    assert as_preview(terrain, (600, 400), (200, 133)).samples == terrain.samples > 1


@pytest.mark.parametrize("grid", [2, 100, 256, 1025])
def test_a_mesh_that_somebody_set_stays(terrain: Sketch, grid: int):
    chosen = terrain.with_values({"view.grid": grid})
    assert values_of(as_preview(chosen))["view.land.grid"] == grid
    alone = replace(chosen, samples=1)
    assert as_preview(alone) is alone


def test_what_draws_no_mesh_is_drawn_as_it_is(tmp_path: Path):
    (tmp_path / "flat.toml").write_text(SKETCH.partition("[view]")[0], encoding="utf-8")
    flat = load(tmp_path / "flat.toml")
    assert flat.samples > 1 and as_preview(flat) is flat


def test_draws_that_must_share_a_mesh_still_do():
    """What is drawn over at equal depth has to have the same triangles."""
    sketch = load("splat_mask")
    values = values_of(as_preview(sketch))
    grids = [value for path, value in values.items() if path.endswith(".grid")]
    assert len(grids) > 1 and set(grids) == {GRID}


def test_the_preview_shows_the_same_land(terrain: Sketch, any_engine: Engine):
    preview = any_engine.render(as_preview(terrain), size=(160, 90)).array.astype(np.float64)
    full = any_engine.render(terrain, size=(160, 90)).array.astype(np.float64)
    far = np.abs(preview - full).max(axis=2) > 32
    assert (preview != full).any() and far.mean() < 0.1
