"""A context is lost with all that is in it: the session goes on in another, as it was."""

from __future__ import annotations

import gc
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.engine.context import abandon
from playground.engine.engine import open_engine
from playground.sketch.assign import values_of
from playground.sketch.model import Camera
from playground.studio.reload.stages import ReloadStage
from playground.studio.session import Session

SIZE = (64, 48)
TERRAIN = """#pragma kernel(output = "height:r32f", repeat = "4")
uniform float level = 0.25; //! slider(0, 1)
float kernel(ivec2 texel) {
    return previous(texel) * 0.5 + level * float(texel.x + texel.y) * fract(time) / float(size.x);
}
"""
SKETCH = """format = 1
size = 33
[[pass]]
name = "height"
use = "./terrain"
[view]
use = "view/terrain"
samples = 4
"""


class Machine:
    """A session whose context can be taken away."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        (folder / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
        (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
        self.is_lost = False
        self.engine = open_engine()
        self.session = Session(self.engine, folder, is_lost=lambda: self.is_lost)

    def picture(self) -> np.ndarray:
        self.session.frame(SIZE)
        frame = self.session.read()
        assert frame is not None
        assert self.engine.ctx.error == "GL_NO_ERROR"
        return frame.array

    def lose(self) -> None:
        """Take the context away and give the session another."""
        abandon(self.engine.ctx)
        self.engine = open_engine()
        self.session.rebuild(self.engine)
        self.is_lost = False

    def save(self, old: str, new: str) -> None:
        assert old in TERRAIN
        (self.folder / "terrain.glsl").write_text(TERRAIN.replace(old, new), encoding="utf-8")
        self.session.drafts.reload()


@pytest.fixture
def machine(tmp_path: Path) -> Iterator[Machine]:
    made = Machine(tmp_path)
    yield made
    made.session.release()
    made.engine.release()


@pytest.mark.slow
def test_everything_is_there_again_the_picture_to_the_bit(machine: Machine) -> None:
    session = machine.session
    session.clock.time = 0.4
    machine.picture()
    session.drafts.set("height.level", 0.75)
    session.drafts.set_camera(Camera(azimuth=70.0, elevation=40.0, distance=9000.0))
    session.stop_at("height", 3)
    before, edits = machine.picture(), session.shown.edits
    for _ in range(2):
        machine.lose()
        np.testing.assert_array_equal(machine.picture(), before)
        gc.collect()  # what was made in the old context goes: it must not take its namesakes with it
        session.drafts.set_camera(Camera(azimuth=71.0, elevation=40.0, distance=9000.0))
        machine.picture()
        session.drafts.set_camera(edits.camera)
        np.testing.assert_array_equal(machine.picture(), before)
        assert session.shown.edits == edits and session.clock.time == 0.4
        assert session.view.steps == {"height": 3}
    assert session.error is None and any("was reset" in note for note in session.notes)


@pytest.mark.slow
def test_what_is_coming_and_what_is_wrong_stay(machine: Machine) -> None:
    before = machine.picture()
    machine.save("* 0.5", "* undeclared")
    machine.picture()
    message = str(machine.session.error)
    assert "undeclared" in message
    machine.lose()
    np.testing.assert_array_equal(machine.picture(), before)
    assert str(machine.session.error) == message
    machine.save("* 0.5", "* 0.25")
    machine.lose()
    machine.session.clock.time = 0.3
    assert not np.array_equal(machine.picture(), before) and machine.session.error is None
    assert "0.25" in machine.session.sketch.graph.find("height").technique.source.code


def test_what_costs_the_context_is_not_drawn_again(machine: Machine) -> None:
    before = machine.picture()
    machine.save("* 0.5", "* 0.25")
    machine.is_lost = True
    machine.session.frame(SIZE)
    assert machine.session.drafts.stage is ReloadStage.FAILED and "reset itself" in str(machine.session.error)
    machine.lose()
    np.testing.assert_array_equal(machine.picture(), before)
    assert "reset itself" in str(machine.session.error)
    machine.save("* 0.5", "* 0.5")
    assert machine.session.error is None


@pytest.mark.slow
def test_a_value_that_costs_two_contexts_waits_for_another(machine: Machine) -> None:
    machine.picture()
    machine.session.drafts.set("height.level", 0.75)
    machine.picture()
    machine.lose()
    machine.picture()
    machine.lose()
    assert machine.session.frame(SIZE) is None
    assert "reset itself twice" in str(machine.session.error)
    machine.session.drafts.set("height.level", 0.5)
    machine.picture()
    assert machine.session.error is None and values_of(machine.session.sketch)["height.level"] == 0.5
