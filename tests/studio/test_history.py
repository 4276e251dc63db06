"""Undo, presets, locks and saving in a session, as keys and buttons ask for them."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.paths import SKETCHES
from playground.sketch.assign import values_of
from playground.sketch.model import Camera
from playground.studio.actions import rounded
from playground.studio.bench import Workbench
from playground.studio.interface import WindowControls
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import map_of_height

SIZE = (48, 32)
KERNEL = """// terrain.glsl -- a slope
#pragma kernel(output = "height:r32f")
uniform float level = 0.25; //! slider(0, 1)
uniform float other = 0.0; //! slider(0, 1)
float kernel(ivec2 texel) { return level * float(texel.x) / float(size.x) + other; }
"""
SKETCH = (
    "format = 1  # ours\nsize = 33\n"
    + map_of_height()
    + '[[preset]]\nname = "high"\nset = { "height.level" = 1.0, "height.other" = 0.5 }\n'
)


class Harness:
    """A sketch, a session on it, and what a person can ask for."""

    def __init__(self, engine: Engine, folder: Path, path: Path | None = None) -> None:
        self.folder = folder
        if path is None:
            (folder / "terrain.glsl").write_text(KERNEL, encoding="utf-8")
            (folder / "other.glsl").write_text(KERNEL.replace("terrain", "other"), encoding="utf-8")
            (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
        self.session = Session(engine, path or folder)
        self.time = 0.0
        self.bench = Workbench(
            self.session, WindowControls(lambda: None), folder=folder, now=lambda: self.time
        )
        self.frame()

    def frame(self) -> np.ndarray:
        """Let a turn of the window pass, a second after the one before; return the picture."""
        self.time += 1.0
        self.session.frame(SIZE)
        self.bench.undo.record()
        self.bench.take_notes()
        frame = self.session.read()
        assert frame is not None and self.session.error is None
        return frame.array

    def value(self, name: str) -> object:
        assert self.session.sketch is not None
        return values_of(self.session.sketch)[f"height.{name}"]

    @property
    def text(self) -> str:
        return (self.folder / "sketch.toml").read_text(encoding="utf-8")

    @property
    def messages(self) -> str:
        return "; ".join(notice.text for notice in self.bench.notices.items)


@pytest.fixture
def harness(tmp_path: Path, any_engine: Engine) -> Iterator[Harness]:
    made = Harness(any_engine, tmp_path)
    yield made
    made.session.release()


def test_everything_is_undone_and_done_again(harness: Harness) -> None:
    session, bench = harness.session, harness.bench
    pictures = [harness.frame()]
    for act in (
        lambda: session.drafts.set("height.level", 0.5),
        lambda: bench.commands.apply_preset("high"),
        lambda: session.drafts.choose("height", "./other"),
        lambda: session.drafts.set_camera(Camera(azimuth=3.0)),
        lambda: session.drafts.lock("height.other", True),
        lambda: bench.commands.reset_values(),
        lambda: bench.undo.seek(2.5),
        lambda: bench.commands.set_all("Random, seed 1", {"height.level": 0.125}),
    ):
        act()
        pictures.append(harness.frame())
    assert len(bench.undo.history.steps) == 8
    assert harness.value("other") == 0.5, "the reset left what is locked"
    for picture in reversed(pictures[:-1]):
        bench.undo.undo()
        np.testing.assert_array_equal(harness.frame(), picture)
    assert session.clock.time == 0.0 and session.shown is not None
    assert session.shown.edits.values == () and session.sketch == session.shown.file
    for picture in pictures[1:]:
        bench.undo.redo()
        np.testing.assert_array_equal(harness.frame(), picture)
    assert session.clock.time == 2.5 and session.shown.edits.locked == ("height.other",)
    bench.undo.go_to(2)
    np.testing.assert_array_equal(harness.frame(), pictures[2])
    bench.undo.redo()
    bench.undo.go_to(0)
    harness.frame()
    bench.undo.undo()
    assert "nothing to undo" in harness.messages


def test_a_locked_parameter_is_left_by_presets(harness: Harness) -> None:
    harness.session.drafts.lock("height.level", True)
    harness.bench.commands.apply_preset("high")
    harness.frame()
    assert (harness.value("level"), harness.value("other")) == (0.25, 0.5)
    assert "1 parameter; 1 locked parameter left alone" in harness.messages


def test_what_is_saved_is_in_the_file_and_can_still_be_undone(harness: Harness) -> None:
    harness.session.drafts.set("height.level", 0.5)
    harness.frame()
    harness.session.drafts.set_camera(Camera(azimuth=12.3456, elevation=30.0))
    before = harness.frame()
    harness.bench.commands.save_values()
    assert 'use = "./terrain"\nset = { level = 0.5 }\n' in harness.text and "azimuth = 12.35" in harness.text
    assert harness.text.startswith("format = 1  # ours\n")
    np.testing.assert_array_equal(harness.frame(), before)
    assert harness.session.shown is not None
    assert harness.session.shown.edits.values == () and harness.session.shown.edits.camera is None
    assert "saved 1 value and the camera" in harness.messages and "is taken" not in harness.messages
    harness.bench.undo.undo()
    harness.frame()
    assert harness.session.sketch is not None
    assert harness.session.sketch.camera == Camera() and harness.value("level") == 0.5
    harness.bench.undo.undo()
    assert harness.value("level") == 0.25, "what the file said before"
    harness.bench.commands.save_values()
    harness.frame()
    assert "set = { level = 0.25 }" in harness.text and "azimuth = 200" in harness.text
    for _ in range(2):
        harness.bench.undo.redo()
        harness.frame()
    assert harness.value("level") == 0.5 and harness.session.sketch.camera.azimuth == 12.35


def test_a_technique_is_saved_and_undone(harness: Harness) -> None:
    harness.session.drafts.choose("height", "./other")
    harness.frame()
    harness.bench.commands.save_values()
    harness.frame()
    assert 'use = "./other"' in harness.text and harness.session.shown is not None
    assert harness.session.shown.edits.techniques == ()
    harness.bench.undo.undo()
    harness.frame()
    spec = harness.session.shown.base.graph.find("height")
    assert spec is not None and spec.use == "./terrain"


def test_values_by_hand_become_a_preset(harness: Harness) -> None:
    harness.bench.commands.save_as_preset("low")
    assert "would be empty" in harness.messages and "low" not in harness.text
    harness.session.drafts.set("height.level", 0.125)
    harness.bench.commands.save_as_preset(" low ")
    harness.frame()
    assert harness.session.sketch is not None
    assert [p.name for p in harness.session.sketch.presets] == ["high", "low"]
    assert harness.session.sketch.presets[1].values == (("height.level", 0.125),)
    assert harness.value("level") == 0.125 and harness.session.shown is not None
    assert harness.session.shown.edits.has("height.level"), "a preset more is no saved value"


def test_a_file_changed_meanwhile_is_reported(harness: Harness) -> None:
    harness.session.drafts.set("height.level", 0.5)
    text = SKETCH.replace("size = 33", "size = 17")
    (harness.folder / "sketch.toml").write_text(text, encoding="utf-8")
    harness.bench.commands.save_values()
    assert "changed meanwhile" in harness.messages and harness.text == text


def test_a_shipped_sketch_is_offered_as_a_copy(tmp_path: Path, any_engine: Engine) -> None:
    harness = Harness(any_engine, tmp_path, SKETCHES / "white_noise.toml")
    before = (SKETCHES / "white_noise.toml").read_bytes()
    harness.session.drafts.set("height.seed", 4)
    picture = harness.frame()
    harness.bench.commands.save_values()
    assert harness.bench.file.offer == "This sketch belongs to the playground itself."
    harness.bench.commands.save_a_copy()
    np.testing.assert_array_equal(harness.frame(), picture)
    assert harness.session.path == tmp_path / "white_noise" / "sketch.toml"
    assert harness.session.shown is not None and harness.session.shown.edits.values == ()
    assert (SKETCHES / "white_noise.toml").read_bytes() == before
    harness.bench.undo.undo()
    assert harness.value("seed") != 4
    harness.session.release()


@pytest.mark.parametrize("edited", [False, True])
def test_an_elevation_file_is_saved_as_a_sketch_beside_it(tmp_path, any_engine, edited) -> None:
    dem = tmp_path / "data" / "dem.npy"
    dem.parent.mkdir()
    np.save(dem, np.add.outer(np.arange(9.0), np.arange(7.0) ** 2))
    before = dem.read_bytes()
    harness = Harness(any_engine, tmp_path, dem)
    if edited:
        harness.session.drafts.choose("light", "lighting/l_dot_n")
        harness.session.drafts.set("weights.rock_slope", 41.0)
    picture = harness.frame()
    harness.bench.commands.save_values()
    assert f"saved dem.toml in {dem.parent}" in harness.messages and not harness.bench.file.asks
    assert harness.session.path == dem.with_name("dem.toml") and dem.read_bytes() == before
    np.testing.assert_array_equal(harness.frame(), picture)
    saved = load(dem.with_name("dem.toml"))
    assert saved.graph.find("light").use == ("lighting/l_dot_n" if edited else "lighting/ray_cast")
    assert dict(saved.graph.find("weights").values)["rock_slope"] == (41.0 if edited else 30.0)
    harness.bench.commands.save_values()
    assert "nothing differs from the file" in harness.messages


def test_a_step_that_fails_gives_its_name_to_no_other(harness: Harness) -> None:
    with pytest.raises(ZeroDivisionError), harness.bench.undo.step("Random"):
        raise ZeroDivisionError
    harness.session.drafts.set("height.level", 0.5)
    harness.frame()
    assert [step.name for step in harness.bench.undo.history.steps] == [""]


def test_saved_camera_is_rounded_to_short_decimals() -> None:
    result = rounded(Camera(12.3456, 30.0, 1234.5678, (1 / 3, 2.0, 3.0), 35.0))
    assert result == Camera(12.35, 30.0, 1234.57, (0.33, 2.0, 3.0), 35.0)


class Brush:
    """A brush that is on, with so many strokes to take back."""

    on = True

    def __init__(self, strokes: int) -> None:
        self.strokes = strokes
        self.undone = 0
        self.layer = self

    @property
    def can_undo(self) -> bool:
        return self.strokes > 0

    @property
    def can_redo(self) -> bool:
        return self.undone > 0

    def undo(self) -> None:
        self.strokes, self.undone = self.strokes - 1, self.undone + 1

    def redo(self) -> None:
        self.strokes, self.undone = self.strokes + 1, self.undone - 1


def test_undo_and_redo_while_painting_affect_strokes_not_values(harness: Harness) -> None:
    harness.session.drafts.set("height.level", 0.5)
    harness.frame()
    brush = Brush(1)
    harness.bench.undo.painting = brush  # type: ignore[assignment]
    harness.bench.undo.undo()
    assert brush.strokes == 0 and harness.value("level") == 0.5
    assert "took the last stroke back; put the brush down (B) to undo values" in harness.messages
    harness.bench.undo.undo()
    assert "no stroke to take back" in harness.messages and harness.value("level") == 0.5
    harness.bench.undo.redo()
    assert brush.strokes == 1 and harness.value("level") == 0.5
    assert "painted the stroke again; put the brush down (B) to redo values" in harness.messages
    harness.bench.undo.redo()
    assert "no stroke to paint again" in harness.messages
    brush.on = False
    harness.bench.undo.undo()
    assert harness.value("level") == 0.25
