"""While a source is at work the window shows the last picture, how far it is, and takes changes."""

from __future__ import annotations

import threading
from datetime import datetime
from pathlib import Path

import numpy as np
import pytest

from playground.engine import sources
from playground.engine.engine import Engine
from playground.engine.process.worker import Cancelled
from playground.engine.sandbox import SandboxReport
from playground.engine.source_kinds import SourceKind
from playground.studio.overlay import behind_text
from playground.studio.paint.brush import Brush
from playground.studio.paint.painting import Painting
from playground.studio.session import Session

from ..sketch_texts import map_of, passes
from .session_desk import FakeSandbox

SOURCE = """#pragma source("slow", output = "height:r32f")
uniform sampler2D given;   //! input("black")
uniform float gain = 0.5;  //! slider(0, 1)
"""
SIZE = (16, 16)


@pytest.fixture
def cancelled():
    return threading.Event()


@pytest.fixture
def gate(monkeypatch, cancelled):
    opened = threading.Event()
    opened.set()

    def work(values, size, material):
        for done in range(50):
            material.report(done, 100)
        try:
            while not opened.wait(0.002):
                material.report(50, 100)
        except Cancelled:
            cancelled.set()
            raise
        return {"height": np.full(size[::-1], values["gain"], np.float32)}

    kind = SourceKind("the slow", ("gain",), inputs=("given",), work=work)
    monkeypatch.setitem(sources.SOURCES, "slow", kind)
    yield opened
    opened.set()


@pytest.fixture
def session(tmp_path: Path, any_engine: Engine, gate):
    (tmp_path / "slow.glsl").write_text(SOURCE, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(
        "format = 1\nsize = 9\n" + passes(height="./slow") + map_of("height", "red"), encoding="utf-8"
    )
    made = Session(any_engine, tmp_path / "sketch.toml")
    drawn(made)
    yield made
    made.release()


def drawn(session: Session) -> np.ndarray:
    for _ in range(500):
        session.frame(SIZE)
        if session.catch_up.behind is None:
            frame = session.read()
            assert frame is not None and session.error is None
            return frame.array
    raise AssertionError("it never ends")


def test_the_last_picture_stays_until_the_source_has_ended(session, gate):
    before, draws = drawn(session), session.draws
    gate.clear()
    session.drafts.set("height.gain", 0.9)
    for _ in range(3):
        assert session.frame(SIZE) is not None
    assert session.catch_up.behind == (50, 100) and session.catch_up.source == "height"
    assert session.draws == draws and not session.is_idle and session.error is None
    assert behind_text(50, 100, "height") == "making height … 50 %"
    session.clock.playing, at = True, session.clock.time
    session.advance(0.5, datetime(2026, 1, 1))
    assert session.clock.time == at, "the clock waits"
    gate.set()
    after = drawn(session)
    assert session.catch_up.source == "" and not np.array_equal(before, after)
    np.testing.assert_array_equal(after[0, 0, :3], after[-1, -1, :3])


def test_a_value_set_back_shows_at_once_and_stops_the_work(session, gate, cancelled):
    before = drawn(session)
    gate.clear()
    session.drafts.set("height.gain", 0.9)
    session.frame(SIZE)
    assert session.catch_up.behind is not None
    session.drafts.set("height.gain", 0.5)
    session.frame(SIZE)
    assert session.catch_up.behind is None
    np.testing.assert_array_equal(drawn(session), before)
    assert cancelled.wait(5.0)


def test_first_picture_reading_file_draws_once_source_ends(session, any_engine, gate, tmp_path):
    """What the sandbox has read is not new any more, though nothing was drawn with it yet."""
    np.save(tmp_path / "hills.npy", np.eye(9, dtype=np.float32))
    file = ("generation/heightmap", 'set = { elevation = "hills.npy" }')
    text = passes(hills=file, height=("./slow", 'inputs = { given = "hills" }')) + map_of("height", "red")
    (tmp_path / "other.toml").write_text("format = 1\nsize = 9\n" + text, encoding="utf-8")
    gate.clear()
    made = Session(any_engine, tmp_path / "other.toml", sandbox=FakeSandbox())
    made.drafts._checks.sandbox.answer = SandboxReport(True)
    for _ in range(5):
        made.frame(SIZE)
    assert made.catch_up.source == "height" and made.draws == 0
    gate.set()
    drawn(made)
    assert made.draws == 1 and made.plan is not None
    made.release()


# ── what waits for nothing ───────────────────────────────────────────────────

SCULPTED = (
    """format = 1
size = 33
extent = [2000.0, 2000.0]
relief = 200.0
"""
    + passes(low="./slow", height="generation/sculpted", light="lighting/l_dot_n").replace(
        'use = "generation/sculpted"', 'use = "generation/sculpted"\ninputs = { height = "low" }'
    )
    + """[view]
use = "view/terrain"
samples = 1
camera = { azimuth = 180, elevation = 60, distance = 3000 }
"""
)


class Opening:
    """A gate that opens by itself after some seconds, so that who waits for it fails and does not hang."""

    def __init__(self, gate: threading.Event) -> None:
        self.waited = False
        self._timer = threading.Timer(3.0, self._open, [gate])
        self._timer.start()

    def _open(self, gate: threading.Event) -> None:
        self.waited = True
        gate.set()

    def close(self) -> None:
        self._timer.cancel()


@pytest.fixture
def closed(gate):
    gate.clear()
    opening = Opening(gate)
    yield opening
    opening.close()


def test_values_are_not_waited_for(session, gate, closed):
    session.drafts.set("height.gain", 0.9)
    session.frame(SIZE)
    assert session.read_values("height") is None and not closed.waited
    assert session.notes[-1] == "height is being made, 50 of 100: try again when it is there"
    session.show("height")
    assert not closed.waited and session.view.map is not None, "it is shown when it is there"
    gate.set()
    drawn(session)
    assert session.read_values("height").max() == np.float32(0.9)


@pytest.mark.parametrize("hovers", [True, False])
def test_a_brush_that_is_pressed_waits_for_no_source(any_engine, gate, closed, tmp_path, hovers):
    (tmp_path / "slow.glsl").write_text(SOURCE, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SCULPTED, encoding="utf-8")
    gate.set()
    made = Session(any_engine, tmp_path / "sketch.toml")
    drawn(made)
    painting = Painting(made, tmp_path)
    painting.toggle()
    painting.brush = Brush(tool="flatten", radius=150.0)
    if hovers:
        assert painting.ground((0.5, 0.5)) is not None
    gate.clear()
    made.drafts.set("low.gain", 0.9)
    made.frame(SIZE)
    assert made.catch_up.source == "low"
    made.notes.clear()
    painting.press((0.5, 0.5))
    painting.move((0.5, 0.52))
    painting.release()
    assert not closed.waited and painting.layer is None, "nothing is painted on ground that is not there"
    assert made.notes and all("low is being made" in note for note in made.notes)
    gate.set()
    drawn(made)
    painting.press((0.5, 0.5))
    painting.release()
    assert painting.layer is not None
    made.release()
