"""Previews: fewer samples and vertices, where nobody set more, and never what is saved."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.engine import renderer
from playground.engine.engine import Engine
from playground.sketch.assign import values_of
from playground.sketch.model import Sketch
from playground.studio.picture.full_screen import Enlarger
from playground.studio.picture.preview import GRID, GRID_OF_FEWER, as_preview
from playground.studio.session import Session

from ..loading import load

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
    assert chosen.picture.samples == 1 and values_of(chosen)["view.land.grid"] == GRID
    assert values_of(chosen) == values_of(terrain) | {"view.land.grid": GRID}
    assert chosen.terrain.size == terrain.terrain.size


def test_fewer_pixels_have_a_coarser_mesh_still(terrain: Sketch):
    assert values_of(as_preview(terrain, (600, 400), (600, 400)))["view.land.grid"] == GRID
    assert values_of(as_preview(terrain, (600, 400), (300, 200)))["view.land.grid"] == GRID_OF_FEWER


@pytest.mark.slow
def test_half_of_the_pixels_a_side_jump_no_more_than_stated(any_engine: Engine):
    """docs/explanation/performance.md: half a level of 255 in the mean, and the skyline by a pixel or two."""
    size, half = (960, 540), (480, 270)
    sketch = load("jacksboro")
    full = any_engine.render(sketch, size=size).array[..., :3].astype(np.float64)
    small = any_engine.draw(as_preview(sketch, size, half), size=half)
    with any_engine.borrowed():
        target = any_engine.ctx.simple_framebuffer(size, 4)
        enlarger = Enlarger(any_engine.ctx)
        enlarger.draw(small, target)
        data = target.read(components=3, alignment=1)
        enlarger.release()
        target.release()
    moving = np.frombuffer(data, np.uint8).reshape(size[1], size[0], 3)[::-1].astype(np.float64)
    assert abs(moving.mean() - full.mean()) < 0.5

    def skyline(picture: np.ndarray) -> np.ndarray:
        steps = np.abs(np.diff(picture.mean(axis=2), axis=0)) > 18
        return np.argmax(steps, axis=0)

    shifts = np.abs(skyline(moving) - skyline(full))
    assert np.median(shifts) <= 1 and np.percentile(shifts, 95) <= 2


@pytest.mark.parametrize("pixels", [(600, 400), (300, 200), (150, 100)])
def test_a_preview_has_one_sample_however_few_its_pixels(terrain: Sketch, pixels: tuple[int, int]):
    assert as_preview(terrain, (600, 400), pixels).picture.samples == 1 < terrain.picture.samples


@pytest.mark.parametrize("grid", [2, 100, 256, 1025])
def test_a_mesh_that_somebody_set_stays(terrain: Sketch, grid: int):
    chosen = terrain.with_values({"view.grid": grid})
    assert values_of(as_preview(chosen))["view.land.grid"] == grid
    alone = chosen.with_picture(samples=1)
    assert as_preview(alone) is alone


def test_what_draws_no_mesh_is_drawn_as_it_is(tmp_path: Path):
    (tmp_path / "flat.toml").write_text(SKETCH.partition("[view]")[0], encoding="utf-8")
    flat = load(tmp_path / "flat.toml")
    assert flat.picture.samples > 1 and as_preview(flat) is flat


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


def test_preview_picks_own_variants_when_full_picture_moves(terrain: Sketch, any_engine: Engine):
    """What would run of the full picture is no pass of the preview, where the terrain is drawn first."""
    session = Session(any_engine, terrain.file)
    try:
        session.clock.playing = False
        session.frame((640, 360))
        session.read()  # in full
        assert session.sketch is not None and session.error is None
        camera = session.sketch.camera
        for number in range(1, 4):
            session.drafts.set_camera(replace(camera, azimuth=camera.azimuth + number))
            session.frame((640, 360))
            assert session.error is None
            assert session.is_preview == any_engine.info.software
        ran = set(any_engine.record.ran)
        assert ("view.fast.land" if any_engine.info.software else "view.land") in ran
    finally:
        session.release()


def test_a_saved_text_is_planned_as_a_preview_alone(
    terrain: Sketch, any_engine: Engine, monkeypatch: pytest.MonkeyPatch
):
    """The plan in full waits until the picture is there; what only has another comment is asked of that."""
    file = Path(terrain.file)
    kernel = file.parent / "own.glsl"
    file.write_text(SKETCH.replace("generation/diamond_square", "./own"), encoding="utf-8")
    text = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.1; }\n'
    kernel.write_text(text, encoding="utf-8")
    planned: list[int] = []
    plan = renderer.planned
    monkeypatch.setattr(
        renderer,
        "planned",
        lambda sketch, request: planned.append(sketch.picture.samples) or plan(sketch, request),
    )
    session = Session(any_engine, file)
    try:
        session.frame((640, 360))
        session.read()
        other = text.replace("0.1", "0.2")
        for saved, in_full in ((other, False), (f"{other}// the same\n", True)):
            kernel.write_text(saved, encoding="utf-8")
            planned.clear()
            session.drafts.reload()
            session.frame((640, 360))
            assert session.error is None
            if any_engine.info.software:
                assert (max(planned) > 1) is in_full
            session.read()
    finally:
        session.release()
