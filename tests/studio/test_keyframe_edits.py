"""Keyframes by hand: added where one looks, moved, eased, deleted, undone; the file says each at once."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.engine.engine import Engine
from playground.sketch.model import Camera
from playground.studio.bench import Workbench
from playground.studio.interface import WindowControls
from playground.studio.session import Session

from ..loading import load
from ..sketch_texts import LIT_NOISE, SMALL_VIEW
from .panel_desk import Bare

SKETCH = (
    """format = 1  # ours
size = 33
extent = 1000.0
relief = 200.0
"""
    + LIT_NOISE
    + SMALL_VIEW
)
SIZE = (48, 32)


@pytest.fixture
def path(tmp_path: Path) -> Path:
    result = tmp_path / "sketch.toml"
    result.write_text(SKETCH, encoding="utf-8")
    return result


@pytest.fixture
def bench(any_engine: Engine, path: Path) -> Iterator[Workbench]:
    session = Session(any_engine, path)
    made = Workbench(session, WindowControls(lambda: None), folder=path.parent)
    draw_frame(made)
    yield made
    session.release()


def draw_frame(bench: Workbench) -> np.ndarray:
    for _ in range(2):
        bench.session.frame(SIZE)
        bench.undo.record()
        bench.take_notes()
    assert bench.session.error is None
    frame = bench.session.read()
    assert frame is not None
    return frame.array


def add(bench: Workbench, time: float, camera: Camera, gain: float) -> np.ndarray:
    bench.session.clock.time = time
    bench.session.drafts.set_camera(camera)
    bench.session.drafts.set("light.gain", gain)
    before = draw_frame(bench)
    assert bench.keyframes.add_here(bench.keyframes.changed_paths)
    after = draw_frame(bench)
    assert np.array_equal(before, after), "the keyframe shows what was seen when it was added"
    return after


def test_what_is_seen_is_keyed_and_is_no_longer_set_by_hand(bench: Workbench, path: Path) -> None:
    first = add(bench, 0.0, Camera(200.0, 30.0, 1500.0), 1.0)
    second = add(bench, 2.0, Camera(120.0, 50.0, 900.0), 2.5)
    draft = bench.session.shown
    assert draft is not None and draft.edits.camera is None and draft.edits.values == ()
    result = load(path)
    assert [k.time for k in result.keyframes] == [0.0, 2.0]
    assert path.read_text(encoding="utf-8").startswith(SKETCH)
    bench.session.clock.time = 0.0
    assert np.array_equal(draw_frame(bench), first)
    bench.session.clock.time = 1.0
    between = result.at(1.0)
    assert 900.0 < between.camera.distance < 1500.0
    assert not np.array_equal(draw_frame(bench), first) and not np.array_equal(draw_frame(bench), second)


@pytest.mark.slow
def test_each_step_is_undone_and_done_again_in_the_file_too(bench: Workbench, path: Path) -> None:
    texts = [path.read_text(encoding="utf-8")]

    def step(done: bool) -> None:
        assert done
        draw_frame(bench)
        texts.append(path.read_text(encoding="utf-8"))

    add(bench, 0.0, Camera(200.0, 30.0, 1500.0), 1.0)
    texts.append(path.read_text(encoding="utf-8"))
    add(bench, 2.0, Camera(120.0, 50.0, 900.0), 2.5)
    texts.append(path.read_text(encoding="utf-8"))
    step(bench.keyframes.move(1, 3.0))
    step(bench.keyframes.set_ease(0, "linear"))
    step(bench.keyframes.delete(1))
    names = [step.name for step in bench.undo.history.steps if step.name]
    assert names == [
        "Keyframe at 0 s",
        "Keyframe at 2 s",
        "Keyframe to 3 s",
        "Keyframe: linear",
        "Delete the keyframe at 3 s",
    ]
    written = [load(path).keyframes]
    while bench.undo.history.can_undo:
        bench.undo.undo()
        draw_frame(bench)
        written.append(load(path).keyframes)
    assert path.read_text(encoding="utf-8") == texts[0]
    assert [len(frames) for frames in dict.fromkeys(written)] == [1, 2, 2, 2, 1, 0]
    while bench.undo.history.can_redo:
        bench.undo.redo()
        draw_frame(bench)
    assert [(k.time, k.ease) for k in load(path).keyframes] == [(0.0, "linear")]


def test_undoing_a_keyframe_gives_back_what_was_set_by_hand(bench: Workbench) -> None:
    picture = add(bench, 1.0, Camera(200.0, 30.0, 1500.0), 2.0)
    bench.undo.undo()
    assert np.array_equal(draw_frame(bench), picture)
    draft = bench.session.shown
    assert draft is not None and draft.edits.camera == Camera(200.0, 30.0, 1500.0)
    assert dict(draft.edits.values) == {"light.gain": 2.0} and draft.file.keyframes == ()


def test_a_second_at_the_same_time_goes_into_the_first(bench: Workbench, path: Path) -> None:
    add(bench, 1.0, Camera(200.0, 30.0, 1500.0), 2.0)
    bench.session.drafts.set("light.ambient", 0.25)
    draw_frame(bench)
    assert bench.keyframes.add_here(["light.ambient"], camera=False)
    (result,) = load(path).keyframes
    assert (
        dict(result.values) == {"light.gain": 2.0, "light.ambient": 0.25}
        and dict(result.camera)["azimuth"] == 200
    )


@pytest.mark.slow
def test_an_invalid_edit_is_reported_and_nothing_is_written(bench: Workbench, path: Path) -> None:
    assert not bench.keyframes.add_here([], camera=False)
    assert "choose what the keyframe sets" in bench.notices.items[-1].text
    assert not bench.keyframes.add_here(["size"], camera=False)
    assert "is of the terrain" in bench.notices.items[-1].text
    assert path.read_text(encoding="utf-8") == SKETCH
    add(bench, 0.0, Camera(distance=900.0), 1.0)
    add(bench, 1.0, Camera(distance=800.0), 2.0)
    assert not bench.keyframes.move(1, 0.0)
    assert "there is a keyframe at 0 s already" in bench.notices.items[-1].text
    with pytest.raises(ValueError, match="expected smooth, linear, hold"):
        bench.keyframes.set_ease(0, "bouncy")


def test_the_whole_terrain_is_given_in_metres(bench: Workbench, path: Path) -> None:
    assert bench.keyframes.add_here([])
    draw_frame(bench)
    (result,) = load(path).keyframes
    plan = bench.session.plan
    assert plan is not None and dict(result.camera)["distance"] == pytest.approx(plan.eye.distance, abs=0.01)


@pytest.mark.slow
def test_a_sketch_that_ships_offers_a_copy(any_engine: Engine, tmp_path: Path) -> None:
    session = Session(any_engine, "l_dot_n", values={"size": 33})
    bench = Workbench(session, WindowControls(lambda: None), folder=tmp_path)
    draw_frame(bench)
    assert not bench.keyframes.add_here([])
    assert bench.file.asks and "belongs to the playground" in bench.file.offer
    session.release()


def test_the_panel_s_list(any_engine: Engine, path: Path) -> None:
    bare = Bare(any_engine, path, (1280, 3000))
    try:
        bare.click("Keyframes###keyframes", 0.3)
        bare._watch(imgui, "radio_button")
        for time in (0.0, 2.0):
            bare.session.clock.time = time
            bare.session.drafts.set("light.gain", 1.0 + time)
            bare.run_frames(2)
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
