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
def land(tmp_path: Path) -> Sketch:
    (tmp_path / "land.toml").write_text(SKETCH, encoding="utf-8")
    return load(tmp_path / "land.toml")


def test_it_has_one_sample_and_a_coarser_mesh(land: Sketch):
    chosen = as_preview(land)
    assert chosen.samples == 1 and values_of(chosen)["view.land.grid"] == GRID
    assert values_of(chosen) == values_of(land) | {"view.land.grid": GRID}
    assert chosen.size == land.size


@pytest.mark.parametrize("grid", [2, 100, 256, 1025])
def test_a_mesh_that_somebody_asked_for_stays(land: Sketch, grid: int):
    asked = land.with_values({"view.grid": grid})
    assert values_of(as_preview(asked))["view.land.grid"] == grid
    alone = replace(asked, samples=1)
    assert as_preview(alone) is alone


def test_what_draws_no_mesh_is_drawn_as_it_is(tmp_path: Path):
    (tmp_path / "flat.toml").write_text(SKETCH.partition("[view]")[0], encoding="utf-8")
    flat = load(tmp_path / "flat.toml")
    assert flat.samples > 1 and as_preview(flat) is flat


def test_draws_that_must_share_a_mesh_still_do():
    """What is drawn over at equal depth has to stand on the same triangles."""
    sketch = load("splat_mask")
    values = values_of(as_preview(sketch))
    grids = [value for path, value in values.items() if path.endswith(".grid")]
    assert len(grids) > 1 and set(grids) == {GRID}


def test_the_hasty_picture_shows_the_same_land(land: Sketch, any_engine: Engine):
    hasty = any_engine.render(as_preview(land), size=(160, 90)).array.astype(np.float64)
    full = any_engine.render(land, size=(160, 90)).array.astype(np.float64)
    far = np.abs(hasty - full).max(axis=2) > 32
    assert (hasty != full).any() and far.mean() < 0.1
