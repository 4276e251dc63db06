"""Captures from the window: what is shown, at any size, made in another process meanwhile."""

from __future__ import annotations

import time
from collections.abc import Iterator
from fractions import Fraction
from pathlib import Path

import numpy as np
import pytest

from playground.api import headless
from playground.capture.job import FILM, PICTURE, PICTURES, SHEET, Job, do
from playground.capture.job_process import JobProcess
from playground.engine.engine import Engine
from playground.errors import ParameterError, PlaygroundError
from playground.images.files import read_png
from playground.sketch.assign import resolve
from playground.workbench import captures as capturing
from playground.workbench.actions import Actions
from playground.workbench.captures import Capturing, Wish, job_of, parts_of, size_of, summary, sweep_text
from playground.workbench.session import Session

from .desk import Bare

LAND = """// land.glsl -- a slope that goes up
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform int kind = 0; //! menu("one", "two")
uniform vec3 tint = vec3(1.0); //! colour
float kernel(ivec2 texel) { return level * float(texel.x + kind) / float(size.x) + fract(time); }
"""
SKETCH = """format = 1
size = 33
[[pass]]
name = "height"
use = "./land"
[view]
use = "view/map"
inputs = { shown = "height" }
set = { channel = "red" }
[[keyframe]]
time = 0.0
set = { "height.tint" = "#000000" }
[[keyframe]]
time = 0.5
set = { "height.tint" = "#ffffff" }
"""
LIMIT = 90.0  # [s] for a job to end on a slow machine
SIZE = (40, 30)


@pytest.fixture
def actions(any_engine: Engine, tmp_path: Path) -> Iterator[Actions]:
    (tmp_path / "land.glsl").write_text(LAND.replace("fract(time)", "fract(0.25 * time)"), encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    (tmp_path / "out").mkdir()
    session = Session(any_engine, tmp_path)
    made = Actions(session, lambda: None, tmp_path / "out")
    session.frame(SIZE)
    assert session.error is None
    yield made
    made.capture.close()
    session.release()


def done(actions: Actions) -> None:
    """Start what is wished for, and wait until it has ended; the window goes on meanwhile."""
    actions.capture.start(actions)
    wait(actions)


def wait(actions: Actions) -> None:
    end = time.monotonic() + LIMIT
    while actions.capture.working is not None:
        assert time.monotonic() < end
        actions.session.frame(SIZE)
        actions.capture.look(actions)
        time.sleep(0.01)


def said(actions: Actions) -> str:
    return "\n".join(notice.text for notice in actions.notices)


def test_a_picture_is_what_the_window_shows_with_all_that_is_set_by_hand(actions: Actions) -> None:
    actions.session.drafts.set("height.level", 0.2)
    actions.session.clock.time = 1.5
    actions.session.frame(SIZE)
    frame = actions.session.read()
    assert frame is not None
    done(actions)
    made = actions.capture.last
    assert made == actions.folder / f"{made.name}" and actions.saved == made, said(actions)
    pixels, _ = read_png(made)
    assert np.array_equal(pixels, frame.array)
    assert f"saved {made}, 40 x 30 pixels" in said(actions)
    actions.capture.wish.multiple = 4
    done(actions)
    assert actions.capture.last is not None and actions.capture.last != made
    assert read_png(actions.capture.last)[0].shape == (120, 160, 4)


def test_what_stops_leaves_nothing_and_the_window_may_close_meanwhile(actions: Actions) -> None:
    actions.capture.wish = Wish(PICTURE, multiple=0, size=(6000, 6000))
    actions.capture.start(actions)
    assert actions.capture.working is not None
    actions.capture.working.stop()
    wait(actions)
    assert "the capture was stopped" in said(actions) and list(actions.folder.iterdir()) == []
    actions.capture.start(actions)
    actions.capture.close()
    assert actions.capture.working is None and list(actions.folder.iterdir()) == []


def test_a_process_that_dies_is_told(actions: Actions) -> None:
    actions.capture.wish = Wish(PICTURE, multiple=0, size=(6000, 6000))
    actions.capture.start(actions)
    assert actions.capture.working is not None
    actions.capture.working._worker._process.kill()
    wait(actions)
    assert actions.capture.failed.startswith("the capture "), actions.capture.failed


def test_numbered_pictures_a_film_and_a_sheet(actions: Actions) -> None:
    """In this process, by the job that the other one does."""
    progress: list[tuple[int, int]] = []
    wish = Wish(PICTURES, seconds=0.2, fps=10, start=1.0)
    with headless() as engine:

        def made(wish: Wish) -> Path:
            progress.clear()
            job = job_of(wish, actions)
            return do(job, engine, lambda done, of: progress.append((done, of)), lambda _: None)

        folder = made(wish)
        assert [path.name for path in sorted(folder.iterdir())] == ["00000.png", "00001.png"]
        assert progress == [(0, 2), (1, 2), (2, 2)]
        job = job_of(wish, actions)
        for number in range(2):
            wanted = engine.render(job.sketch, size=SIZE, time=1.0 + number / 10).array
            assert np.array_equal(read_png(folder / f"{number:05d}.png")[0], wanted)
        assert made(wish).name == f"{folder.name}-2"
        sheet = made(Wish(SHEET, sweeps=["height.level=0..1,3", ""]))
        assert sheet.name.endswith("-sweep.png") and progress[-1] == (3, 3)
        pytest.importorskip("av")
        film = made(Wish(FILM, seconds=0.0, fps=10, ending=".gif"))
        assert film.suffix == ".gif" and progress[-1] == (5, 5), "to the last keyframe"
    assert not list(actions.folder.rglob("*.part"))


def test_what_cannot_be_made_is_said_before_anything_begins(
    actions: Actions, monkeypatch: pytest.MonkeyPatch
) -> None:
    for wish, sentence in (
        (Wish(SHEET), "choose a parameter to sweep"),
        (Wish(SHEET, sweeps=["height.levle=0..1", ""]), "level"),
        (Wish(PICTURE, multiple=0, size=(70000, 10)), "expected 1 to 65536"),
        (Wish(FILM, ending=".gif", fps=30), "A GIF cannot|a GIF cannot"),
    ):
        with pytest.raises(PlaygroundError, match=sentence):
            job_of(wish, actions)
        actions.capture.wish = wish
        actions.capture.start(actions)
        assert actions.capture.working is None and actions.capture.failed
        assert actions.capture.failed in said(actions)


def test_without_pyav_one_sentence_with_the_command(
    actions: Actions, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "av", None)
    job = job_of(Wish(FILM, seconds=0.2, fps=10), actions)
    with pytest.raises(PlaygroundError, match="pip install"):
        do(job, actions.session.engine, lambda *_: None, lambda _: None)
    assert list(actions.folder.iterdir()) == []


def test_sizes_and_lengths(actions: Actions) -> None:
    assert size_of(Wish(PICTURE, multiple=8), actions) == (320, 240)
    assert size_of(Wish(FILM, multiple=0, size=(33, 21)), actions) == (34, 22)
    assert size_of(Wish(SHEET), actions) == (320, 240)
    assert summary(Wish(FILM, seconds=2.0, fps=30), actions) == "60 pictures of 40 x 30 pixels"
    assert summary(Wish(FILM, fps=10), actions) == "5 pictures of 40 x 30 pixels"
    assert "expected" in summary(Wish(PICTURE, multiple=0, size=(0, 1)), actions)
    with pytest.raises(ParameterError):
        size_of(Wish(FILM, multiple=0, size=(20000, 100)), actions)


def test_the_map_is_captured_where_it_is_shown(actions: Actions) -> None:
    actions.session.show("height:height")
    actions.session.frame(SIZE)
    assert actions.session.view.map is not None
    assert job_of(Wish(), actions).sketch == actions.session.view.map.of(actions.session.sketch)  # type: ignore[arg-type]


def test_a_chosen_parameter_is_swept_over_its_range(actions: Actions) -> None:
    graph = actions.session.sketch.graph  # type: ignore[union-attr]
    level, kind, tint = (resolve(graph, f"height.{n}")[0].parameter for n in ("level", "kind", "tint"))
    assert sweep_text("height.level", level) == "height.level=0..1,9"
    assert sweep_text("height.kind", kind) == "height.kind=one,two"
    assert parts_of(tint) == ("r", "g", "b") and parts_of(level) == ("",)
    for text in (sweep_text("height.kind", kind), sweep_text("height.tint", tint, "g")):
        assert job_of(Wish(SHEET, sweeps=[text, ""]), actions).sweeps == (text,)


def test_the_folder_is_shown_or_named(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    calls: list[object] = []
    monkeypatch.setattr(capturing.sys, "platform", "linux")
    monkeypatch.setattr(capturing.subprocess, "Popen", lambda words, **_: calls.append(words))
    file = tmp_path / "x.png"
    file.touch()
    assert capturing.open_folder(file) == "" and capturing.open_folder(tmp_path) == ""
    assert calls == [["xdg-open", str(tmp_path)]] * 2

    def missing(*_: object, **__: object) -> None:
        raise FileNotFoundError

    monkeypatch.setattr(capturing.subprocess, "Popen", missing)
    assert str(tmp_path) in capturing.open_folder(file)


def test_a_job_takes_a_new_name_every_time(actions: Actions) -> None:
    job = job_of(Wish(), actions)
    engine = actions.session.engine
    names = [do(job, engine, lambda *_: None, lambda _: None).name for _ in range(3)]
    stem = job.sketch.name
    assert names == [f"{stem}.png", f"{stem}-2.png", f"{stem}-3.png"]


def test_a_job_in_its_process_gives_the_bytes_of_this_one(actions: Actions) -> None:
    job = Job(
        kind=PICTURE,
        sketch=job_of(Wish(), actions).sketch,
        folder=actions.folder,
        size=(64, 64),
        fps=Fraction(30),
    )
    working = JobProcess(job, software=actions.session.engine.info.software)
    end = time.monotonic() + LIMIT
    while (finished := working.poll()) is None and time.monotonic() < end:
        time.sleep(0.01)
    assert finished is not None and finished.path is not None, finished
    here = actions.session.engine.render(job.sketch, size=(64, 64))
    assert np.array_equal(read_png(finished.path)[0], here.array)
    assert working.progress == (1, 1)


def test_the_window_is_there_for_c_and_goes_with_esc(
    any_engine: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    from imgui_bundle import imgui

    from playground.live.capture_window import draw_capture

    (tmp_path / "land.glsl").write_text(LAND, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    bare = Bare(any_engine, tmp_path / "sketch.toml")
    started: list[Wish] = []
    monkeypatch.setattr(Capturing, "start", lambda self, _: started.append(self.wish))
    draw = bare.draw

    def both() -> None:
        draw()
        draw_capture(bare.actions.capture, bare.actions, bare.theme)

    monkeypatch.setattr(bare, "draw", both)
    try:
        bare.key(imgui.Key.c)
        bare.turn(3)
        assert bare.actions.capture.shown
        wish = bare.actions.capture.wish
        for name, kind in (("Film", FILM), ("Numbered pictures", PICTURES), ("Sheet of a sweep", SHEET)):
            bare.click("##kind")
            bare.click(name)
            assert wish.kind == kind
        bare.click("##swept0", 0.99)
        bare.click("height.level")
        assert wish.sweeps[0] == "height.level=0..1,9"
        bare.key(imgui.Key.escape)
        assert not bare.actions.capture.shown and not bare.quits
    finally:
        bare.close()
