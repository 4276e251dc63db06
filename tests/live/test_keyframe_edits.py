"""Keyframes by hand: added where one looks, moved, eased, deleted, undone; the file says each at once."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.sketch.load import load
from playground.sketch.model import Camera
from playground.workbench import keyframe_edits as keying
from playground.workbench.actions import Actions
from playground.workbench.session import Session

from .desk import Bare

SKETCH = """format = 1  # ours
size = 33
extent = 1000.0
relief = 200.0
[[pass]]
name = "height"
use = "generation/white_noise"
[[pass]]
name = "light"
use = "lighting/l_dot_n"
[view]
use = "view/terrain"
set = { grid = 9 }
"""
SIZE = (48, 32)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    found = tmp_path / "sketch.toml"
    found.write_text(SKETCH, encoding="utf-8")
    return found


@pytest.fixture
def actions(any_engine: Engine, path: Path) -> Iterator[Actions]:
    session = Session(any_engine, path)
    made = Actions(session, lambda: None, path.parent)
    turn(made)
    yield made
    session.release()


def turn(actions: Actions) -> np.ndarray:
    for _ in range(2):
        actions.session.frame(SIZE)
        actions.look_back(False)
        actions.take_notes()
    assert actions.session.error is None
    frame = actions.session.read()
    assert frame is not None
    return frame.array


def add(actions: Actions, time: float, camera: Camera, gain: float) -> np.ndarray:
    actions.session.clock.time = time
    actions.session.drafts.set_camera(camera)
    actions.session.drafts.set("light.gain", gain)
    before = turn(actions)
    assert keying.add_here(actions, keying.changed_paths(actions))
    after = turn(actions)
    assert np.array_equal(before, after), "the keyframe shows what was seen when it was added"
    return after


def test_what_is_seen_is_keyed_and_is_no_longer_set_by_hand(actions: Actions, path: Path) -> None:
    first = add(actions, 0.0, Camera(200.0, 30.0, 1500.0), 1.0)
    second = add(actions, 2.0, Camera(120.0, 50.0, 900.0), 2.5)
    draft = actions.session.shown
    assert draft is not None and draft.edits.camera is None and draft.edits.values == ()
    found = load(path)
    assert [k.time for k in found.keyframes] == [0.0, 2.0]
    assert path.read_text(encoding="utf-8").startswith(SKETCH)
    actions.session.clock.time = 0.0
    assert np.array_equal(turn(actions), first)
    actions.session.clock.time = 1.0
    between = found.at(1.0)
    assert 900.0 < between.camera.distance < 1500.0
    assert not np.array_equal(turn(actions), first) and not np.array_equal(turn(actions), second)


def test_each_step_is_undone_and_done_again_in_the_file_too(actions: Actions, path: Path) -> None:
    texts = [path.read_text(encoding="utf-8")]

    def step(done: bool) -> None:
        assert done
        turn(actions)
        texts.append(path.read_text(encoding="utf-8"))

    add(actions, 0.0, Camera(200.0, 30.0, 1500.0), 1.0)
    texts.append(path.read_text(encoding="utf-8"))
    add(actions, 2.0, Camera(120.0, 50.0, 900.0), 2.5)
    texts.append(path.read_text(encoding="utf-8"))
    step(keying.move(actions, 1, 3.0))
    step(keying.set_ease(actions, 0, "linear"))
    step(keying.delete(actions, 1))
    names = [step.name for step in actions.history.steps if step.name]
    assert names == [
        "Keyframe at 0 s",
        "Keyframe at 2 s",
        "Keyframe to 3 s",
        "Keyframe: linear",
        "Delete the keyframe at 3 s",
    ]
    said = [load(path).keyframes]
    while actions.history.can_undo:
        actions.undo()
        turn(actions)
        said.append(load(path).keyframes)
    assert path.read_text(encoding="utf-8") == texts[0]
    assert [len(frames) for frames in dict.fromkeys(said)] == [1, 2, 2, 2, 1, 0]
    while actions.history.can_redo:
        actions.redo()
        turn(actions)
    assert [(k.time, k.ease) for k in load(path).keyframes] == [(0.0, "linear")]


def test_undoing_a_keyframe_gives_back_what_was_set_by_hand(actions: Actions) -> None:
    picture = add(actions, 1.0, Camera(200.0, 30.0, 1500.0), 2.0)
    actions.undo()
    assert np.array_equal(turn(actions), picture)
    draft = actions.session.shown
    assert draft is not None and draft.edits.camera == Camera(200.0, 30.0, 1500.0)
    assert dict(draft.edits.values) == {"light.gain": 2.0} and draft.file.keyframes == ()


def test_a_second_at_the_same_time_goes_into_the_first(actions: Actions, path: Path) -> None:
    add(actions, 1.0, Camera(200.0, 30.0, 1500.0), 2.0)
    actions.session.drafts.set("light.ambient", 0.25)
    turn(actions)
    assert keying.add_here(actions, ["light.ambient"], camera=False)
    (found,) = load(path).keyframes
    assert (
        dict(found.values) == {"light.gain": 2.0, "light.ambient": 0.25}
        and dict(found.camera)["azimuth"] == 200
    )


def test_what_cannot_be_is_said_and_nothing_is_written(actions: Actions, path: Path) -> None:
    assert not keying.add_here(actions, [], camera=False)
    assert "choose what the keyframe sets" in actions.notices[-1].text
    assert not keying.add_here(actions, ["size"], camera=False)
    assert "is the land's" in actions.notices[-1].text
    assert path.read_text(encoding="utf-8") == SKETCH
    add(actions, 0.0, Camera(distance=900.0), 1.0)
    add(actions, 1.0, Camera(distance=800.0), 2.0)
    assert not keying.move(actions, 1, 0.0)
    assert "there is a keyframe at 0 s already" in actions.notices[-1].text
    with pytest.raises(ValueError, match="expected smooth, linear, hold"):
        keying.set_ease(actions, 0, "bouncy")


def test_the_whole_land_is_said_in_metres(actions: Actions, path: Path) -> None:
    assert keying.add_here(actions, [])
    turn(actions)
    (found,) = load(path).keyframes
    plan = actions.session.plan
    assert plan is not None and dict(found.camera)["distance"] == pytest.approx(plan.eye.distance, abs=0.01)


def test_a_sketch_that_ships_offers_a_copy(any_engine: Engine, tmp_path: Path) -> None:
    session = Session(any_engine, "l_dot_n", values={"size": 33})
    actions = Actions(session, lambda: None, tmp_path)
    turn(actions)
    assert not keying.add_here(actions, [])
    assert actions.opening == "offer" and "belongs to the playground" in actions.offer
    session.release()


def test_the_panel_s_list(any_engine: Engine, path: Path) -> None:
    bare = Bare(any_engine, path, (1280, 3000))
    try:
        bare.click("Keyframes###keyframes", 0.3)
        bare._watch(imgui, "radio_button")
        for time in (0.0, 2.0):
            bare.session.clock.time = time
            bare.session.drafts.set("light.gain", 1.0 + time)
            bare.turn(2)
            bare.click("Add keyframe here")
        assert [k.time for k in load(path).keyframes] == [0.0, 2.0]
        assert dict(load(path).keyframes[1].values) == {"light.gain": 3.0}
        bare.click("##go")
        assert bare.session.clock.time == 2.0 and not bare.session.clock.playing
        bare.click("##ease")
        bare.click("hold")
        assert "hold" in [k.ease for k in load(path).keyframes]
    finally:
        bare.close()
