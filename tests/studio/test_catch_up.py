"""A jump in time runs in pieces: the window answers, says how far it is, and the clock waits."""

from __future__ import annotations

from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.engine.unfinished import Unfinished
from playground.studio.overlay import behind_text
from playground.studio.picture import shown_picture
from playground.studio.session import Session

from ..sketch_texts import map_of, passes

COUNT = """#pragma kernel(output = "count:r32f")
uniform sampler2D before;  //! input("zero")
float kernel(ivec2 texel) { return texelFetch(before, texel, 0).r + 1.0 / 256.0; }
"""
SKETCH = (
    "format = 1\nsize = 9\n"
    + passes(count=("./count", 'repeat = "frames"', 'feedback = { before = "count" }'))
    + map_of("count", "red")
)
SIZE = (16, 16)


@pytest.fixture
def session(tmp_path: Path, any_engine: Engine):
    (tmp_path / "count.glsl").write_text(COUNT, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    made = Session(any_engine, tmp_path / "sketch.toml")
    made.clock.playing = False
    made.frame(SIZE)
    assert made.error is None
    yield made
    made.release()


@pytest.fixture
def slow(session, monkeypatch):
    """Let each look at the clock find that time is over."""
    monkeypatch.setattr(shown_picture, "LOOP_PIECE", -1.0)
    return session


def test_time_jump_shows_progress_and_ends_at_same_picture(slow):
    engine = slow.engine
    slow.clock.time, before = 1.0, engine.runs["count"]
    done = []
    while True:
        slow.frame(SIZE)
        if slow.catch_up.behind is None:
            break
        done.append(slow.catch_up.behind)
        assert not slow.is_idle
        assert len(done) < 100
    assert done == [(number, 61) for number in range(5, 61, 4)], "each piece goes on from the last"
    assert engine.runs["count"] - before <= 60 + 2 * len(done), "a picture on the way is one frame at most"
    assert slow.clock.time == 1.0
    array = slow.read().array
    with Engine(engine.ctx) as cold:
        np.testing.assert_array_equal(array, cold.render(slow.sketch, size=SIZE, time=1.0).array)


def test_the_clock_waits_while_the_picture_is_behind(slow):
    slow.clock.playing, slow.clock.time = True, 1.0
    slow.frame(SIZE)
    assert slow.catch_up.behind == (5, 61)
    slow.advance(0.5, datetime(2026, 1, 1))
    assert slow.clock.time == 1.0
    while slow.catch_up.behind is not None:
        slow.frame(SIZE)
    slow.advance(0.5, datetime(2026, 1, 1))
    assert slow.clock.time == 1.5


def test_a_picture_that_is_read_is_that_of_its_time(slow):
    slow.clock.time = 1.0
    slow.frame(SIZE)
    result = slow.read()
    assert slow.catch_up.behind is None
    assert result.array[0, 0, 0] > 0
    np.testing.assert_array_equal(result.array, slow.engine.render(slow.sketch, size=SIZE, time=1.0).array)


def test_a_save_at_a_late_time_shows_how_far_it_came_as_well(slow):
    slow.clock.time = 1.0
    path = slow.path.parent / "count.glsl"
    path.write_text(COUNT.replace("256.0", "128.0"), encoding="utf-8")
    slow.drafts.reload()
    slow.frame(SIZE)
    assert slow.catch_up.behind == (8, 61), "a piece to see that it draws, and one to show"
    while slow.catch_up.behind is not None:
        slow.frame(SIZE)
    assert slow.engine.runs["count"] <= 1 + 61 + 2 * 15


def test_a_short_run_is_not_parted(session, monkeypatch):
    monkeypatch.setattr(shown_picture, "LOOP_PIECE", 3600.0)  # shorter than that on a busy machine too
    session.clock.time = 1.0
    session.frame(SIZE)
    assert session.catch_up.behind is None


def test_an_engine_without_patience_runs_to_the_end(any_engine, session):
    any_engine.options.patience = -1.0
    with pytest.raises(Unfinished) as stopped:
        any_engine.draw(session.sketch, size=SIZE, time=2.0)
    assert stopped.value.total == 121
    any_engine.options.patience = None
    assert any_engine.draw(session.sketch, size=SIZE, time=2.0) is not None


def test_what_the_window_says():
    assert behind_text(1200, 36000) == "computing frame 1,200 of 36,000 …"
