"""A full picture is drawn in pieces while the preview stays: the window answers between its passes."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.engine.context import ContextInfo
from playground.engine.engine import Engine
from playground.engine.unfinished import PassesUnfinished
from playground.studio.picture import shown_picture
from playground.studio.session import Session

from ..loading import load

SIZE = (160, 90)
SKETCH = """format = 1
size = 65
extent = 640
relief = 200
[[pass]]
name = "height"
use = "generation/diamond_square"
[[pass]]
name = "colour"
use = "texturing/height_colour"
[[pass]]
name = "light"
use = "lighting/l_dot_n"
[view]
use = "view/terrain"
set = { sea = true, sea_level = 60 }
"""


@pytest.fixture
def session(tmp_path: Path, any_engine: Engine, monkeypatch) -> Iterator[Session]:
    """A session at rest, drawn in full, in which a piece is a single pass."""
    monkeypatch.setattr(ContextInfo, "software", True)
    monkeypatch.setattr(shown_picture, "REST", 0.0)
    monkeypatch.setattr(shown_picture, "PIECE", 0.0)
    (tmp_path / "sea.toml").write_text(SKETCH, encoding="utf-8")
    with Engine(any_engine.ctx) as engine:
        result = Session(engine, tmp_path / "sea.toml")
        result.clock.playing = False
        result.frame(SIZE)
        result.read()
        yield result
        result.release()


def turned(session: Session, azimuth: float) -> None:
    session.drafts.set_camera(replace(load(session.path).camera, azimuth=azimuth))


def of_a_full_picture(session: Session) -> list[str]:
    """Return the passes that a full picture runs after a preview of another camera, in their order."""
    turned(session, 10.0)
    session.frame(SIZE)
    session.read()
    return list(session.engine.record.ran)


def pieces(session: Session) -> list[list[str]]:
    """Draw frames until the picture rests; return the passes that each of them ran."""
    names = []
    while session.is_preview:
        session.frame(SIZE)
        assert session.error is None and len(names) < 20
        names.append(list(session.engine.record.ran))
    return names


def test_each_piece_runs_what_is_left(session: Session):
    expected = of_a_full_picture(session)
    assert len(expected) > 2
    turned(session, 40.0)
    session.frame(SIZE)
    preview = session.picture.frame("", 0.0).array
    assert session.is_preview
    assert pieces(session) == [[path] for path in expected]
    full = session.engine.render(session.sketch, size=SIZE).array
    np.testing.assert_array_equal(session.picture.frame("", 0.0).array, full)
    assert (preview != full).any()


def test_the_preview_stays_until_the_last(session: Session):
    expected = of_a_full_picture(session)
    turned(session, 40.0)
    session.frame(SIZE)
    preview, draws = session.picture.frame("", 0.0).array, session.draws
    for _ in expected[:-1]:
        session.frame(SIZE)
        np.testing.assert_array_equal(session.picture.frame("", 0.0).array, preview)
        assert session.is_preview and session.draws == draws and not session.is_idle
    session.frame(SIZE)
    assert session.draws == draws + 1 and session.is_idle


def test_motion_during_full_draw_shows_at_once_then_in_full(session: Session):
    turned(session, 40.0)
    for _ in range(3):
        session.frame(SIZE)
    turned(session, 70.0)
    session.frame(SIZE)
    assert session.is_preview and session.plan.sketch.camera.azimuth == 70.0
    assert pieces(session)[-1][-1] == "view.present"
    full = session.engine.render(session.sketch, size=SIZE).array
    np.testing.assert_array_equal(session.picture.frame("", 0.0).array, full)


def test_what_is_read_back_is_whole_at_once(session: Session):
    turned(session, 40.0)
    session.frame(SIZE)
    session.frame(SIZE)
    array = session.read().array
    assert not session.is_preview
    np.testing.assert_array_equal(array, session.engine.render(session.sketch, size=SIZE).array)


def test_pieces_grow_so_that_a_picture_ends_that_no_cache_holds(session: Session, monkeypatch):
    """With no room for textures each piece would begin again for ever."""
    monkeypatch.setattr(shown_picture, "PIECE", 1e-4)
    monkeypatch.setattr(shown_picture, "STEADY", 3)
    monkeypatch.setattr(session.engine.cache, "limit", 1)
    turned(session, 40.0)
    session.frame(SIZE)
    assert pieces(session)


def test_all_passes_run_where_no_piece_is_asked_for(session: Session):
    options = session.engine.options
    options.piece = lambda: True
    with pytest.raises(PassesUnfinished):
        session.engine.render(session.sketch.with_values({"height.seed": 99}), size=SIZE)
    options.piece = None
    session.engine.render(session.sketch.with_values({"height.seed": 99}), size=SIZE)
