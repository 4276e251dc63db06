"""The sketch that `playground new` makes: its first picture shows all of the terrain, and little else."""

from __future__ import annotations

import tomllib
from pathlib import Path

import numpy as np

from playground.course.tasks.texts import EXERCISES
from playground.engine.camera import look
from playground.engine.engine import Engine
from playground.paths import SKETCHES
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


def test_an_empty_sketch_is_the_one_of_the_first_lesson_with_the_kernel_that_it_begins_with(
    engine: Engine, tmp_path: Path
) -> None:
    made = make_sketch(tmp_path / "first", empty=True)
    assert sorted(path.name for path in made.iterdir()) == ["height.glsl", "sketch.toml"]
    assert (made / "height.glsl").read_bytes() == (EXERCISES / "first_height/empty.glsl").read_bytes()
    assert not engine.read(load(made), "height").any()
    own, shipped = (
        tomllib.loads(path.read_text()) for path in (made / "sketch.toml", SKETCHES / "first_height.toml")
    )
    assert own["pass"][0].pop("use") == "./height"
    assert shipped["pass"][0].pop("use") == "generation/first_height"
    assert own.pop("title") == "First" and shipped.pop("title")
    assert "main" not in own and shipped.pop("main")  # the kernel begins without parameters
    assert own["shot"][0].pop("name") and shipped["shot"][0].pop("name")
    assert own == shipped
