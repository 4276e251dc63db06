"""Captures from the window: what is shown, at any size, made in another process meanwhile."""

from __future__ import annotations

import os
import re
import signal
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from imgui_bundle import imgui

from playground.api import headless
from playground.data.image_files import read_png
from playground.engine.engine import Engine
from playground.errors import ParameterError, PlaygroundError
from playground.extras import install_command
from playground.publish.addition import open_addition
from playground.publish.capture_job import FILM, PICTURE, PICTURES, SHEET, do
from playground.publish.sweep import parts_of, sweep_text
from playground.publish.window import captures as capturing
from playground.publish.window.captures import Captures, CaptureSettings
from playground.sketch.assign import resolve
from playground.studio.bench import Host
from playground.studio.edits.autosave import Autosave, memory_of
from playground.studio.edits.memory import Remembered
from playground.studio.keys import open_layers
from playground.studio.notices import Notices
from playground.studio.session import Session

from ...sketch_texts import map_of_height
from ...studio.panel_desk import Bare

TERRAIN = """// terrain.glsl -- a slope that goes up
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1)
uniform int kind = 0; //! menu("one", "two")
uniform vec3 tint = vec3(1.0); //! colour
float kernel(ivec2 texel) { return level * float(texel.x + kind) / float(size.x) + fract(time); }
"""
SKETCH = (
    "format = 1\nsize = 33\n"
    + map_of_height(channel="red")
    + """[[keyframe]]
time = 0.0
set = { "height.tint" = "#000000" }
[[keyframe]]
time = 0.5
set = { "height.tint" = "#ffffff" }
"""
)
LIMIT = 90.0  # [s] for a job to end on a slow machine
SIZE = (40, 30)


@pytest.fixture
def captures(any_engine: Engine, tmp_path: Path) -> Iterator[Captures]:
    (tmp_path / "terrain.glsl").write_text(
        TERRAIN.replace("fract(time)", "fract(0.25 * time)"), encoding="utf-8"
    )
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    (tmp_path / "out").mkdir()
    session = Session(any_engine, tmp_path)
    session.frame(SIZE)
    assert session.error is None
    made = Captures(session, Notices(), tmp_path / "out", lambda: True)
    yield made
    made.close()
    session.release()


def wishing(captures: Captures, settings: CaptureSettings) -> Captures:
    """Return the captures with a wish."""
    captures.settings = settings
    return captures


def wait(captures: Captures) -> None:
    """Wait until the capture has ended; the window goes on meanwhile."""
    end = time.monotonic() + LIMIT
    while captures.working is not None:
        assert time.monotonic() < end
        captures.session.frame(SIZE)
        captures.poll()
        time.sleep(0.01)


def notices_of(captures: Captures) -> str:
    return "\n".join(notice.text for notice in captures.notices.items)


@pytest.mark.slow
def test_capture_matches_window_with_all_manual_settings(captures: Captures) -> None:
    captures.session.drafts.set("height.level", 0.2)
    captures.session.clock.time = 1.5
    captures.session.frame(SIZE)
    frame = captures.session.read()
    assert frame is not None
    captures.start()
    working = captures.working
    wait(captures)
    made = captures.made
    assert working is not None and working.progress == (1, 1)
    assert made == captures.folder / f"{made.name}", notices_of(captures)
    pixels, _ = read_png(made)
    assert np.array_equal(pixels, frame.array)
    assert f"saved {made}, 40 x 30 pixels" in notices_of(captures)
    here = captures.session.engine.render(captures.job().sketch, size=SIZE, time=1.5)
    assert np.array_equal(pixels, here.array), "its process gives the bytes of this one"
    captures.settings.multiple = 4
    larger = do(captures.job(), captures.session.engine, lambda *_: None, lambda _: None)
    assert larger != made and read_png(larger)[0].shape == (120, 160, 4)


@pytest.mark.slow
def test_stopped_capture_leaves_no_file_and_window_may_close(captures: Captures) -> None:
    captures.settings = CaptureSettings(PICTURE, multiple=0, size=(6000, 6000))
    captures.start()
    assert captures.working is not None
    captures.working.stop()
    wait(captures)
    assert "the capture was stopped" in notices_of(captures) and list(captures.folder.iterdir()) == []
    captures.start()
    captures.close()
    assert captures.working is None and list(captures.folder.iterdir()) == []


def test_a_process_that_dies_is_reported(captures: Captures) -> None:
    captures.settings = CaptureSettings(PICTURE, multiple=0, size=(6000, 6000))
    captures.start()
    assert captures.working is not None
    task = captures.working.task
    while not task.begun:
        time.sleep(0.005)
    assert task.slot is not None and task.slot.process is not None
    os.kill(task.slot.process.pid, signal.SIGTERM)
    wait(captures)
    assert captures.failed.startswith("the capture "), captures.failed


def test_numbered_pictures_a_film_and_a_sheet(captures: Captures) -> None:
    """In this process, by the job that the other one does."""
    progress: list[tuple[int, int]] = []
    settings = CaptureSettings(PICTURES, seconds=0.2, fps=10, start=1.0)
    with headless() as engine:

        def made(wish: CaptureSettings) -> Path:
            progress.clear()
            job = wishing(captures, wish).job()
            return do(job, engine, lambda done, of: progress.append((done, of)), lambda _: None)

        folder = made(settings)
        assert [path.name for path in sorted(folder.iterdir())] == ["00000.png", "00001.png"]
        assert progress == [(0, 2), (1, 2), (2, 2)]
        job = wishing(captures, settings).job()
        for number in range(2):
            expected = engine.render(job.sketch, size=SIZE, time=1.0 + number / 10).array
            assert np.array_equal(read_png(folder / f"{number:05d}.png")[0], expected)
        assert made(settings).name == f"{folder.name}-2"
        sheet = made(CaptureSettings(SHEET, sweeps=["height.level=0..1,3", ""]))
        assert sheet.name.endswith("-sweep.png") and progress[-1] == (3, 3)
        pytest.importorskip("av")
        film = made(CaptureSettings(FILM, seconds=0.0, fps=10, ending=".gif"))
        assert film.suffix == ".gif" and progress[-1] == (5, 5), "to the last keyframe"
    assert not list(captures.folder.rglob("*.part"))


def test_an_invalid_capture_is_reported_before_anything_begins(
    captures: Captures, monkeypatch: pytest.MonkeyPatch
) -> None:
    for settings, sentence in (
        (CaptureSettings(SHEET), "choose a parameter to sweep"),
        (CaptureSettings(SHEET, sweeps=["height.levle=0..1", ""]), "level"),
        (CaptureSettings(PICTURE, multiple=0, size=(70000, 10)), "expected 1 to 65536"),
        (CaptureSettings(FILM, ending=".gif", fps=30), "A GIF cannot|a GIF cannot"),
    ):
        with pytest.raises(PlaygroundError, match=sentence):
            wishing(captures, settings).job()
        captures.settings = settings
        captures.start()
        assert captures.working is None and captures.failed
        assert captures.failed in notices_of(captures)


def test_without_pyav_one_sentence_with_the_command(
    captures: Captures, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(__import__("sys").modules, "av", None)
    monkeypatch.setenv("PATH", "")
    job = wishing(captures, CaptureSettings(FILM, seconds=0.2, fps=10)).job()
    with pytest.raises(PlaygroundError, match=re.escape(install_command("video"))):
        do(job, captures.session.engine, lambda *_: None, lambda _: None)
    assert list(captures.folder.iterdir()) == []


def test_sizes_and_lengths(captures: Captures) -> None:
    assert wishing(captures, CaptureSettings(PICTURE, multiple=8)).size() == (320, 240)
    assert wishing(captures, CaptureSettings(FILM, multiple=0, size=(33, 21))).size() == (34, 22)
    assert wishing(captures, CaptureSettings(SHEET)).size() == (320, 240)
    assert (
        wishing(captures, CaptureSettings(FILM, seconds=2.0, fps=30)).summary()
        == "60 pictures of 40 x 30 pixels"
    )
    assert wishing(captures, CaptureSettings(FILM, fps=10)).summary() == "5 pictures of 40 x 30 pixels"
    assert "expected" in wishing(captures, CaptureSettings(PICTURE, multiple=0, size=(0, 1))).summary()
    with pytest.raises(ParameterError):
        wishing(captures, CaptureSettings(FILM, multiple=0, size=(20000, 100))).size()


def test_the_map_is_captured_where_it_is_shown(captures: Captures) -> None:
    captures.session.show("height:height")
    captures.session.frame(SIZE)
    view = captures.session.view
    assert view.map is not None
    assert wishing(captures, CaptureSettings()).job().sketch == view.map.of(captures.session.sketch)  # type: ignore[arg-type]


def test_a_chosen_parameter_is_swept_over_its_range(captures: Captures) -> None:
    graph = captures.session.sketch.graph  # type: ignore[union-attr]
    level, kind, tint = (resolve(graph, f"height.{n}")[0].parameter for n in ("level", "kind", "tint"))
    assert sweep_text("height.level", level) == "height.level=0..1,9"
    assert sweep_text("height.kind", kind) == "height.kind=one,two"
    assert parts_of(tint) == ("r", "g", "b") and parts_of(level) == ("",)
    for text in (sweep_text("height.kind", kind), sweep_text("height.tint", tint, "g")):
        assert wishing(captures, CaptureSettings(SHEET, sweeps=[text, ""])).job().sweeps == (text,)


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


def test_a_job_takes_a_new_name_every_time(captures: Captures) -> None:
    job = wishing(captures, CaptureSettings()).job()
    engine = captures.session.engine
    names = [do(job, engine, lambda *_: None, lambda _: None).name for _ in range(3)]
    stem = job.sketch.name
    assert names == [f"{stem}.png", f"{stem}-2.png", f"{stem}-3.png"]


def test_capture_waits_for_painted_files_and_none_starts_without(captures: Captures, tmp_path: Path) -> None:
    settled = [True, False]
    waited = Captures(captures.session, Notices(), tmp_path / "none", settled.pop)
    waited.settings = CaptureSettings(SHEET)
    waited.start()
    assert waited.failed == "no capture was made, for what was painted last could not be written"
    waited.start()
    assert waited.failed.startswith("choose a parameter to sweep") and not settled
    assert [notice.text for notice in waited.notices.items][-1] == waited.failed and waited.working is None


def test_the_window_is_there_for_c_and_goes_with_esc(
    any_engine: Engine, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    bare = Bare(any_engine, tmp_path / "sketch.toml")
    memory, remembered = memory_of(bare.session.path), Remembered()
    autosave = Autosave(bare.session, memory, remembered)
    capture = open_addition(Host(bare.bench, autosave, lambda: None, lambda: None, lambda: bare.theme))
    captures = capture.captures
    assert captures.settle == bare.bench.painting.settle
    bare.bench.additions = [capture]
    draw = bare.draw

    def both() -> None:
        draw()
        capture.draw_over()

    monkeypatch.setattr(bare, "draw", both)
    try:
        bare.key(imgui.Key.c)
        bare.run_frames(3)
        assert captures.shown and open_layers(bare.bench) == ["capture"]
        settings = captures.settings
        for name, kind in (("Film", FILM), ("Numbered pictures", PICTURES), ("Sheet of a sweep", SHEET)):
            bare.click("##kind")
            bare.click(name)
            assert settings.kind == kind
        bare.click("##swept0", 0.99)
        bare.click("height.level")
        assert settings.sweeps[0] == "height.level=0..1,9"
        bare.key(imgui.Key.escape)
        assert not captures.shown and not bare.quits
        bare.click("Capture")
        assert captures.shown
    finally:
        autosave.close()
        bare.close()
