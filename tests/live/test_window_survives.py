"""A real window survives what happens to its files, and what a hand does on a slow renderer."""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from .screen import ON_LINUX, Program, Screen

WIDTH, HEIGHT = 900, 600
RUN = """
import os, sys, time
from playground.live.app import run
from playground.live.session import Session
from imgui_bundle import imgui
from playground.live import widgets
slide = widgets._SLIDE[1]
def noting(label, *rest):
    answer = slide(label, *rest)
    low, size = imgui.get_item_rect_min(), imgui.get_item_rect_size()
    with open("slider.txt", "w") as file:
        file.write(f"{label} {low.x + 0.3 * size.x:.0f} {low.y + size.y / 2:.0f}")
    return answer
widgets._SLIDE[1] = lambda label, *rest: (noting if label == "##height.level" else slide)(label, *rest)
if slow := float(os.environ.get("SLOW", "0")):
    draw = Session._draw
    def slowly(*arguments, **named):
        time.sleep(slow)
        return draw(*arguments, **named)
    Session._draw = slowly
sys.exit(run(sys.argv[1], size=(900, 600), time_limit=300))
"""
LAND = """// land.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level * (0.5 + 0.5 * sin(0.3 * float(texel.x))); }
"""
SKETCH = """format = 1
title = "Hills"
size = 65
extent = 1000.0
relief = 200.0
[[pass]]
name = "height"
use = "./land"
[view]
use = "view/terrain"
samples = 1
set = { grid = 33 }
"""
# llvmpipe cuts every loop at 65,535 turns, so that it takes many to keep it busy.
LOOP = " for (int i = 0; i < 60000; i++) s += sin(float(i) + s);"
BUSY = LAND.replace("{ return", f"{{ float s = 0.0;{LOOP * 20} if (s == 0.5) return s; return")

pytestmark = ON_LINUX


@pytest.fixture(scope="module")
def screen(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    made = Screen(tmp_path_factory.mktemp("screen"), WIDTH, HEIGHT)
    yield made
    made.close()


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    home = tmp_path / "my-land"
    home.mkdir()
    (home / "land.glsl").write_text(LAND, encoding="utf-8")
    (home / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return home


@pytest.fixture
def window(screen: Screen, tmp_path: Path, folder: Path) -> Iterator[Program]:
    made = Program(screen, tmp_path, [sys.executable, "-c", RUN, str(folder)], tmp_path)
    made.wait(lambda now: now["draws"] > 0)
    screen.do("mousemove", 600, 100)
    yield made
    made.close()


def look(screen: Screen, name: str) -> None:
    """Write the screen where a person asks for it, to look at it."""
    if os.environ.get("LOOK"):
        from PIL import Image

        Image.fromarray(screen.pixels()).save(Path(os.environ["LOOK"]) / f"{name}.png")


def test_a_sketch_that_vanishes_says_so_and_goes_on_when_it_is_back(
    screen: Screen, window: Program, folder: Path
) -> None:
    first, path = window.now()["picture"], folder / "sketch.toml"
    path.unlink()
    said = window.wait(lambda now: now["error"])["error"]
    assert "the file is gone" in said and "sketch.toml" in said
    time.sleep(0.5)
    look(screen, "gone")
    path.write_text(SKETCH.replace("relief = 200.0", "relief = 300.0"), encoding="utf-8")
    window.wait(lambda now: not now["error"] and now["picture"] != first)
    path.unlink()
    time.sleep(0.15)
    path.write_text(SKETCH, encoding="utf-8")
    window.wait(lambda now: not now["error"] and now["picture"] == first)
    folder.rename(folder.with_name("elsewhere"))
    said = window.wait(lambda now: now["error"])["error"]
    assert "gone with its folder" in said
    time.sleep(0.5)
    look(screen, "folder-gone")
    assert window.now()["picture"] == first, "the last good picture stays"
    folder.with_name("elsewhere").rename(folder)
    window.wait(lambda now: not now["error"] and now["picture"] == first)
    assert window.complaint().count("the file is gone") in (2, 3), "the terminal is told once of each"
    assert "Traceback" not in window.complaint()


def test_a_trial_that_takes_long_is_told_of(screen: Screen, window: Program, folder: Path) -> None:
    (folder / "land.glsl").write_text(BUSY, encoding="utf-8")
    window.wait(lambda now: now["trying"] == "land.glsl")
    time.sleep(1.5)
    look(screen, "trying")
    (folder / "land.glsl").write_text(LAND.replace("level *", "0.9 * level *"), encoding="utf-8")
    window.wait(lambda now: not now["trying"] and now["stage"] == "NONE" and not now["error"])


@pytest.mark.slow
def test_a_double_click_on_a_slow_renderer_opens_a_field_and_no_key_is_lost(
    screen: Screen, tmp_path: Path, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("SLOW", "0.4")
    window = Program(screen, tmp_path, [sys.executable, "-c", RUN, str(folder)], tmp_path)
    try:
        window.wait(lambda now: now["draws"] > 0)
        _, x, y = (tmp_path / "slider.txt").read_text().split()
        for text, value in (("0.25", 0.25), ("0.75", 0.75)):
            click = ["mousedown", "1", "sleep", "0.03", "mouseup", "1"]
            typed = [part for c in text for part in ("key", "period" if c == "." else c)]
            screen.do("mousemove", x, y, "sleep", 0.6, *click, "sleep", 0.1, *click, "sleep", 0.05, *typed)
            window.wait(lambda now: now["takes_text"])
            look(screen, f"typed-{text}")
            screen.do("sleep", 0.6, "key", "Return")
            window.wait(lambda now, value=value: now["edited"].get("height.level") == value)
        now = window.now()
        assert not now["layers"] and not now["map"] and not now["saved"], "no letter was a shortcut"
    finally:
        window.close()


@pytest.mark.slow
def test_esc_never_quits_and_ctrl_q_does(screen: Screen, window: Program) -> None:
    screen.do("key", "g")
    window.wait(lambda now: now["layers"] == ["graph"])
    screen.do("key", "a")
    window.wait(lambda now: now["layers"] == ["graph", "A/B"])
    screen.do("key", "F11")
    window.wait(lambda now: now["layers"] == ["graph", "A/B", "full screen"])
    for left in (["A/B", "full screen"], ["full screen"], []):
        screen.do("key", "Escape")
        window.wait(lambda now, left=left: now["layers"] == left)
    screen.do("key", "Escape")
    window.wait(lambda now: any("Ctrl+Q quits" in text for text in now["notices"]))
    look(screen, "escaped")
    screen.do("keydown", "ctrl", "sleep", 0.1, "key", "q", "keyup", "ctrl")
    assert window.ended() == 0, window.complaint()


def test_the_folder_may_be_deleted_whole(window: Program, folder: Path) -> None:
    shutil.rmtree(folder)
    window.wait(lambda now: "gone with its folder" in now["error"])
