"""A sun dragged with the mouse: which parameters turn, how far, and where they stop."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.studio.picture.gestures import suns_of, turned_sun
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import passes

SKETCH = "format = 1\nsize = 17\n" + passes(
    height="generation/layered_noise",
    light=("lighting/l_dot_n", "set = { sun = { azimuth = 350.0, elevation = 20.0 } }"),
    second=("lighting/l_dot_n", "set = { sun = { azimuth = 90.0, elevation = 85.0 } }"),
)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    file = tmp_path / "sketch.toml"
    file.write_text(SKETCH)
    return file


def test_the_suns_are_those_of_the_passes(path: Path) -> None:
    assert suns_of(load(path)) == {"light.sun": (350.0, 20.0), "second.sun": (90.0, 85.0)}


def test_full_height_drag_turns_sun_half_around_and_quarter_up() -> None:
    assert turned_sun((10.0, 20.0), 1.0, 0.0) == (190.0, 20.0)
    assert turned_sun((350.0, 20.0), 0.25, 0.5) == (35.0, 65.0)


def test_the_sun_stops_overhead_and_a_little_below_the_horizon() -> None:
    assert turned_sun((10.0, 80.0), 0.0, 1.0) == (10.0, 90.0)
    assert turned_sun((10.0, 5.0), 0.0, -1.0) == (10.0, -10.0)


def test_a_drag_turns_every_sun_and_runs_the_light_alone(path: Path, any_engine: Engine) -> None:
    session = Session(any_engine, path)
    try:
        session.frame((64, 48))
        session.drafts.move_suns(0.1, 0.1)
        session.frame((64, 48))
        assert session.sketch is not None
        assert suns_of(session.sketch) == {"light.sun": (8.0, 29.0), "second.sun": (108.0, 90.0)}
        assert not [path for path in any_engine.record.ran if path.startswith("height")]
        assert session.shown is not None and session.shown.edits.has("light.sun")
    finally:
        session.release()
