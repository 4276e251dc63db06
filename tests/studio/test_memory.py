"""What was set by the user is there again after the window is closed, has crashed, or lost its context."""

from __future__ import annotations

import gc
import json
import os
import shutil
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.engine.context import abandon
from playground.engine.engine import Engine, open_engine
from playground.paths import cache_folder, state_folder
from playground.sketch.assign import values_of
from playground.sketch.model import Camera
from playground.studio.edits.autosave import QUIET, TIME, Autosave
from playground.studio.edits.edits import Edits, FileValue
from playground.studio.edits.memory import Compared, Memory, Remembered
from playground.studio.land.land import keep_view, recall_view
from playground.studio.land.looks import Appearance, Look, look_of
from playground.studio.picture.view import Kept
from playground.studio.reload.stages import ReloadStage
from playground.studio.session import Session

from ..cases import each
from ..sketch_texts import TERRAIN_IN_3D as SKETCH

SIZE = (64, 48)
TERRAIN = """#pragma kernel(output = "height:r32f", repeat = "4")
uniform float level = 0.25; //! slider(0, 1)
uniform vec2 slope = vec2(1.0, 2.0);
float kernel(ivec2 texel) {
    return previous(texel) * 0.5 + level * dot(slope, vec2(texel)) * (0.5 + fract(time)) / float(size.x);
}
"""
FULL = Remembered(
    Edits(
        (("height.level", 0.75), ("height.slope", (0.1, 3.0)), ("a.b", True), ("a.c", 7), ("a.d", "snow")),
        (("height", "./other"),),
        Camera(azimuth=10.5, elevation=20.0, distance=900.0, target=(1.0, 2.0, 3.0)),
    ),
    (("height.level", FileValue(0.25, True)), ("height.slope", FileValue((1.0, 2.0), False))),
    12.5,
    False,
    2.0,
    "height:height",
    (("highest", 0.5), ("channel", 1)),
    (("height", 3),),
    (1100, 700),
    (-20, 40),
    Camera(azimuth=200.0, target=(0.0, 0.5, 1.0)),
    (0.5, 2.25),
    Compared(
        Edits((("height.slope", (2.0, 3.0)),), (("height", "./third"),), Camera(elevation=80.0), ("a.b",)),
        (("height", 2),),
        "difference",
        0.25,
        16.0,
    ),
    Kept(
        ((1, Camera(azimuth=180.0, elevation=89.0)), (3, Camera(target=(1.0, 2.0, 3.0)))),
        (("height", (1.5, 2.0)),),
        Appearance(2.5, Look("clay", "height:height", (("sunlight.sun", (120.0, 30.0)),))),
    ),
)


class Place:
    """A sketch, a folder for what is remembered, and a clock."""

    def __init__(self, folder: Path, engine: Engine) -> None:
        self.sketch, self.state, self.engine, self.now = folder / "sketch", folder / "state", engine, 100.0
        self.sketch.mkdir()
        (self.sketch / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
        (self.sketch / "sketch.toml").write_text(SKETCH, encoding="utf-8")
        self.open: list[tuple[Session, Autosave]] = []

    def start(self, **more: object) -> tuple[Session, Autosave]:
        memory = Memory(self.sketch / "sketch.toml", self.state)
        result, complaint = memory.read()
        more |= {"start": result.start}
        session = Session(self.engine, self.sketch, **more)  # type: ignore[arg-type]
        session.notes.extend(filter(None, [complaint]))
        made = session, Autosave(session, memory, result, lambda: self.now)
        self.open.append(made)
        session.frame(SIZE)
        return made

    def other(self) -> Path:
        """Return another sketch, of the same texts."""
        path = self.sketch.parent / "other"
        shutil.copytree(self.sketch, path)
        return path

    def files(self) -> list[str]:
        return sorted(p.name for p in self.state.glob("*.json"))


@pytest.fixture
def place(tmp_path: Path, any_engine: Engine):
    made = Place(tmp_path, any_engine)
    yield made
    for session, autosave in made.open:
        autosave.close()
        session.release()


def picture(session: Session) -> np.ndarray:
    session.frame(SIZE)
    frame = session.read()
    return frame.array


def change_everything(session: Session) -> None:
    session.drafts.set("height.level", 0.75)
    session.drafts.set("height.slope", (0.5, 0.25))
    session.drafts.set_camera(Camera(azimuth=70.0, elevation=50.0, distance=15000.0))
    session.clock.time, session.clock.playing = 0.3, False
    session.stop_at("height", 3)


def test_all_of_it_comes_back_as_it_was(tmp_path: Path) -> None:
    memory = Memory(tmp_path / "sketch.toml", tmp_path)
    assert memory.read() == (Remembered(), "")
    memory.write(FULL)
    assert Memory(tmp_path / "sketch.toml", tmp_path).read() == (FULL, "")
    assert Memory(tmp_path / "other" / "sketch.toml", tmp_path).read() == (Remembered(), ""), "another sketch"
    memory.write(Remembered())
    assert not memory.path.exists(), "there is nothing to remember any more"


def test_a_file_of_before_there_was_more_to_remember_is_read(tmp_path: Path) -> None:
    memory = Memory(tmp_path / "sketch.toml", tmp_path)
    memory.write(FULL)
    table = json.loads(memory.path.read_text(encoding="utf-8"))
    for name in ("at", "camera_in_file", "loop", "compared", "kept"):
        del table[name]
    memory.path.write_text(json.dumps(table), encoding="utf-8")
    expected = replace(FULL, at=None, camera_in_file=None, loop=None, compared=None, kept=Kept())
    assert memory.read() == (expected, "")


def test_the_times_between_which_it_goes_round_come_back(place: Place) -> None:
    session, autosave = place.start()
    session.clock.set_loop(0.5, 2.0)
    autosave.look((900, 600))
    autosave.close()
    again, autosave = place.start()
    assert again.clock.loop == (0.5, 2.0)
    again.clock.loop = None
    autosave.look((900, 600))
    autosave.close()
    assert place.start()[0].clock.loop is None


@pytest.mark.parametrize("moved", [False, True])
def test_manual_camera_yields_if_file_camera_changed_meanwhile(place: Place, moved: bool) -> None:
    session, autosave = place.start()
    by_user = Camera(azimuth=70.0, elevation=50.0, distance=15000.0)
    session.drafts.set_camera(by_user)
    autosave.look((900, 600))
    autosave.close()
    other = SKETCH + ("camera = { azimuth = 12.0 }\n" if moved else "# the same camera\n")
    (place.sketch / "sketch.toml").write_text(other, encoding="utf-8")
    again, _ = place.start()
    assert again.sketch is not None and again.shown is not None
    if moved:
        assert again.sketch.camera == again.shown.file.camera and again.sketch.camera.azimuth == 12.0
        assert list(again.notes) == ["camera: the file's new one is taken"]
    else:
        assert again.sketch.camera == by_user and not again.notes


def test_a_session_goes_on_where_another_ended_to_the_bit(place: Place) -> None:
    session, autosave = place.start()
    change_everything(session)
    before, edits = picture(session), session.shown.edits
    autosave.look((900, 600))
    autosave.close()
    again, _ = place.start()
    assert again.shown.edits == edits and again.view.steps == {"height": 3}
    assert again.clock.time == 0.3 and not again.clock.playing
    np.testing.assert_array_equal(picture(again), before)
    assert not again.notes and again.error is None


def test_a_map_comes_back_too(place: Place) -> None:
    session, autosave = place.start()
    session.show("height:height")
    session.view.set_map("highest", 3.0)
    before = picture(session)
    autosave.look((900, 600))
    autosave.close()
    again, _ = place.start()
    np.testing.assert_array_equal(picture(again), before)


def test_numbered_views_come_back_with_their_sketch(place: Place) -> None:
    session, autosave = place.start()
    picture(session)
    keep_view(session, 2)
    kept = session.sketch.camera
    session.drafts.set_camera(Camera(azimuth=20.0))
    autosave.look((900, 600))
    autosave.close()
    again, _ = place.start()
    picture(again)
    assert recall_view(again, 2) and again.sketch.camera == kept
    assert not recall_view(again, 1)


def test_exaggeration_and_look_come_back_with_their_sketch(place: Place) -> None:
    session, autosave = place.start()
    assert session.frame(SIZE) is not None
    session.exaggerate(2.0)
    session.view.show_as(look_of("slope", session.plan))
    shown = session.view.kept.appearance
    autosave.look((640, 480))
    autosave.close()
    again, autosave = place.start()
    assert again.frame(SIZE) is not None, again.error
    assert again.view.kept.appearance == shown and again.exaggeration == 2.0 and shown.look is not None
    assert again.plan is not None and again.plan.exaggeration == 2.0
    autosave.look((640, 480))
    autosave.open(place.other())
    autosave.look((640, 480))
    assert again.frame(SIZE) is not None and again.view.kept.appearance == Appearance()
    autosave.look((640, 480))
    autosave.open(place.sketch)
    assert again.frame(SIZE) is not None and again.view.kept.appearance == shown


def test_it_is_written_as_one_goes_once_it_rests(place: Place) -> None:
    session, autosave = place.start()
    for value in (0.5, 0.6, 0.7):
        session.drafts.set("height.level", value)
        place.now += QUIET / 2
        autosave.look((900, 600))
        assert place.files() == [] and autosave.waits
    place.now += QUIET
    autosave.look((900, 600))
    assert len(place.files()) == 1 and not autosave.waits
    table = json.loads((place.state / place.files()[0]).read_text())
    assert dict(table["edits"]["values"])["height.level"] == 0.7


def test_time_that_runs_is_written_now_and_then(place: Place) -> None:
    session, autosave = place.start()
    autosave.look((900, 600))
    place.now += QUIET
    autosave.look((900, 600))
    written = []
    for _ in range(100):
        place.now += TIME / 20
        session.clock.time += TIME / 20
        autosave.look((900, 600))
        written.append(json.loads((place.state / place.files()[0]).read_text())["time"])
    assert 4 <= len(set(written)) <= 6


SAYS = {  # what the sketch sets, and the terrain's default, when the user sets 0.75, and afterwards
    "another default": ("", 0.25, "", 0.5),
    "the same": ("level = 0.5", 0.25, "level = 0.5", 0.25),
    "set anew": ("", 0.25, "level = 0.5", 0.25),
    "set to what it was": ("", 0.25, "level = 0.25", 0.25),
    "set otherwise": ("level = 0.125", 0.25, "level = 0.5", 0.25),
    "set no more": ("level = 0.125", 0.25, "", 0.25),
    "set no more, the default as it was set": ("level = 0.25", 0.125, "", 0.25),
    "set to the user's": ("", 0.25, "level = 0.75", 0.25),
}


@pytest.mark.parametrize("locked", [False, True])
@pytest.mark.parametrize("what", SAYS)
def test_a_new_start_and_a_reload_judge_alike(place: Place, what: str, locked: bool) -> None:
    def save(own: str, default: float) -> None:
        text = SKETCH.replace('use = "./terrain"', f'use = "./terrain"\nset = {{ {own} }}')
        (place.sketch / "sketch.toml").write_text(text, encoding="utf-8")
        terrain = TERRAIN.replace("level = 0.25", f"level = {default}")
        (place.sketch / "terrain.glsl").write_text(terrain, encoding="utf-8")

    own, default, then, later = SAYS[what]
    save(own, default)
    session, autosave = place.start()
    session.drafts.set("height.level", 0.75)
    session.drafts.lock("height.level", locked)
    autosave.look((900, 600))
    autosave.close()
    save(then, later)
    session.drafts.reload()
    session.frame(SIZE)
    again, _ = place.start()
    assert again.shown.edits == session.shown.edits
    # Of an edit that changes a default to no effect only the reload reports: a new start knows of no edit.
    assert list(again.notes) == [note for note in session.notes if "the default is" not in note]
    stays = locked or what in ("another default", "the same", "set to what it was") or "as it was" in what
    assert again.shown.edits.has("height.level") == stays


@pytest.mark.parametrize("locked", [False, True])
def test_the_terrain_s_own_values_are_those_of_the_file(place: Place, locked: bool) -> None:
    session, autosave = place.start()
    session.drafts.set("relief", 500.0)
    session.drafts.lock("relief", locked)
    autosave.look((900, 600))
    autosave.close()
    (place.sketch / "sketch.toml").write_text(SKETCH.replace("size = 33", "size = 33\nrelief = 700.0"))
    session.drafts.reload()
    session.frame(SIZE)
    again, _ = place.start()
    assert again.shown.edits == session.shown.edits
    assert again.sketch.terrain.relief == (500.0 if locked else 700.0)


def test_what_the_command_line_sets_goes_before_all(place: Place) -> None:
    session, autosave = place.start()
    change_everything(session)
    autosave.look((900, 600))
    autosave.close()
    again, _ = place.start(values={"height.level": 0.125})
    assert values_of(again.sketch)["height.level"] == 0.125


def test_when_all_is_reset_nothing_is_remembered_but_the_window(place: Place) -> None:
    session, autosave = place.start()
    change_everything(session)
    autosave.look((900, 600))
    autosave.close()
    again, second = place.start()
    again.reset_values()
    again.drafts.set_camera(None)
    again.clock.time, again.clock.playing = 0.0, True
    again.frame(SIZE)
    second.look((900, 600))
    second.close()
    result, _ = Memory(place.sketch / "sketch.toml", place.state).read()
    assert result == Remembered(window=(900, 600))


BROKEN = {
    "empty": "",
    "cut": '{"format": 1, "val',
    "another format": '{"format": 2}',
    "a list": "[]",
    "no number": '{"format": 1, "time": "NaN"}',
    "nested": "[" * 100_000,
    "not text": "\ud800",
}


@pytest.mark.parametrize("name", BROKEN)
def test_a_broken_file_is_set_aside_and_that_is_reported(place: Place, name: str) -> None:
    memory = Memory(place.sketch / "sketch.toml", place.state)
    place.state.mkdir()
    data = BROKEN[name].encode("utf-8", "surrogatepass")
    memory.path.write_bytes(data)
    session, autosave = place.start()
    assert session.shown is not None and session.error is None
    assert "cannot be read" in session.notes[0] and ".unread.json" in session.notes[0]
    assert memory.path.with_suffix(".unread.json").read_bytes() == data, "nothing is lost"
    session.drafts.set("height.level", 0.5)
    autosave.look((900, 600))
    autosave.close()
    result, complaint = memory.read()
    assert complaint == "" and dict(result.edits.values) == {"height.level": 0.5}


@each(
    "key",
    [
        "edits",
        "in_file",
        "camera_in_file",
        "compared",
        "steps",
        "window",
        "at",
        "map_values",
        "time",
        "kept",
    ],
)
@each("wrong", [7, "x", [1], {"a": 1}, [[]], float("inf")])
def test_no_value_of_another_kind_is_taken_or_raises(tmp_path: Path, key: str, wrong: object) -> None:
    memory = Memory(tmp_path / "sketch.toml", tmp_path)
    memory.write(FULL)
    table = json.loads(memory.path.read_text())
    memory.path.write_text(json.dumps(table | {key: wrong}))
    result, complaint = memory.read()
    assert isinstance(result, Remembered) and (complaint or hash(result) is not None)


def test_two_windows_on_one_sketch_do_not_fight(place: Place) -> None:
    first, item = place.start()
    second, two = place.start()
    for session, autosave, value in ((first, item, 0.5), (second, two, 0.75), (first, item, 0.625)):
        session.drafts.set("height.level", value)
        autosave.look((900, 600))
        place.now += QUIET
        autosave.look((900, 600))
    assert any("another window" in note for note in second.notes)
    result, _ = Memory(place.sketch / "sketch.toml", place.state).read()
    assert dict(result.edits.values) == {"height.level": 0.625}
    item.close()
    second.drafts.set("height.level", 0.875)
    two.look((900, 600))
    two.close()
    result, _ = Memory(place.sketch / "sketch.toml", place.state).read()
    assert dict(result.edits.values) == {"height.level": 0.875}, "alone, it remembers"


@pytest.mark.skipif(os.name == "nt" or os.geteuid() == 0, reason="root may write anywhere")
def test_where_nothing_can_be_written_it_is_reported_once(place: Place) -> None:
    place.state.mkdir(mode=0o500)
    check_reported_once(place)


def test_where_the_folder_is_a_file_it_is_reported_once(place: Place) -> None:
    place.state.write_text("not a folder")
    check_reported_once(place)


def check_reported_once(key_path: Place) -> None:
    session, autosave = key_path.start()
    for value in (0.5, 0.75):
        session.drafts.set("height.level", value)
        autosave.look((900, 600))
        key_path.now += QUIET
        autosave.look((900, 600))
    assert len([note for note in session.notes if "cannot be remembered" in note]) == 1


def test_folders_are_the_systems_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    monkeypatch.setattr(Path, "home", lambda: tmp_path)
    name = "terrain-shader-playground"
    assert state_folder("linux", {}) == tmp_path / ".local/state" / name
    assert state_folder("linux", {"XDG_STATE_HOME": str(tmp_path / "s")}) == tmp_path / "s" / name
    assert cache_folder("linux", {"XDG_CACHE_HOME": "relative"}) == tmp_path / ".cache" / name
    assert cache_folder("darwin", {}) == tmp_path / "Library/Caches" / name
    assert state_folder("win32", {"LOCALAPPDATA": str(tmp_path / "L")}) == tmp_path / "L" / name / "state"
    assert state_folder("win32", {}) != cache_folder("win32", {})


# ── session lost ──────────────────────────────────────────────────────────────


LOST_TERRAIN = """#pragma kernel(output = "height:r32f", repeat = "4")
uniform float level = 0.25; //! slider(0, 1)
float kernel(ivec2 texel) {
    return previous(texel) * 0.5 + level * float(texel.x + texel.y) * fract(time) / float(size.x);
}
"""
LOST_SKETCH = """format = 1
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
        (folder / "terrain.glsl").write_text(LOST_TERRAIN, encoding="utf-8")
        (folder / "sketch.toml").write_text(LOST_SKETCH, encoding="utf-8")
        self.is_lost = False
        self.engine = open_engine()
        self.session = Session(self.engine, folder, is_lost=lambda: self.is_lost)

    def picture(self) -> np.ndarray:
        self.session.frame(SIZE)
        frame = self.session.read()
        assert self.engine.ctx.error == "GL_NO_ERROR"
        return frame.array

    def lose(self) -> None:
        """Take the context away and give the session another."""
        abandon(self.engine.ctx)
        self.engine = open_engine()
        self.session.rebuild(self.engine)
        self.is_lost = False

    def save(self, old: str, new: str) -> None:
        assert old in LOST_TERRAIN
        (self.folder / "terrain.glsl").write_text(LOST_TERRAIN.replace(old, new), encoding="utf-8")
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
