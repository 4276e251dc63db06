"""A real window survives what happens to its files, and what a hand does on a slow renderer."""

from __future__ import annotations

import os
import shutil
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from ..data.test_bounds import npz
from .screen import HILLS, ON_LINUX, Program, Screen

WIDTH, HEIGHT = 900, 600
RUN = """
import os, sys, time
from playground.studio.app import run
from playground.studio.session import Session
from imgui_bundle import imgui
slide = imgui.slider_float
def noting(label, *rest):
    answer = slide(label, *rest)
    if label.startswith("##height.level"):
        low, size = imgui.get_item_rect_min(), imgui.get_item_rect_size()
        with open("slider.txt", "w") as file:
            file.write(f"{label} {low.x + 0.3 * size.x:.0f} {low.y + size.y / 2:.0f}")
    return answer
imgui.slider_float = noting
if slow := float(os.environ.get("SLOW", "0")):
    draw = Session._draw
    def slowly(*arguments, **named):
        time.sleep(slow)
        return draw(*arguments, **named)
    Session._draw = slowly
if os.environ.get("BROKEN"):
    from playground.studio.problems import panel as errors_list
    def broken(*_):
        imgui.push_style_color(imgui.Col_.text, (1.0, 0.0, 0.0, 1.0))
        imgui.begin_group()
        imgui.tree_node_ex("###")
        raise IndexError("no such row")
    errors_list.ErrorsList._headline = broken
sys.exit(run(sys.argv[1], size=(900, 600), time_limit=300))
"""
TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level * (0.5 + 0.5 * sin(0.3 * float(texel.x))); }
"""
SKETCH = HILLS + "set = { grid = 33 }\n"
# llvmpipe cuts every loop at 65,535 iterations, so that it takes many to keep it busy.
LOOP = " for (int i = 0; i < 60000; i++) s += sin(float(i) + s);"
BUSY = TERRAIN.replace("{ return", f"{{ float s = 0.0;{LOOP * 20} if (s == 0.5) return s; return")

pytestmark = ON_LINUX


SCREEN = WIDTH, HEIGHT  # [pixels]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    home = tmp_path / "my-terrain"
    home.mkdir()
    (home / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    (home / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return home


@pytest.fixture
def window(screen: Screen, folder: Path) -> Iterator[Program]:
    made = opened(screen, folder)
    screen.do("mousemove", 600, 100)
    yield made
    made.close()


def opened(screen: Screen, folder: Path) -> Program:
    made = Program(screen, folder.parent, [sys.executable, "-c", RUN, str(folder)], folder.parent)
    made.wait(lambda now: now["draws"] > 0)
    return made


def look(screen: Screen, name: str) -> None:
    """Write the screen where a person asks for it, to look at it."""
    if os.environ.get("LOOK"):
        from PIL import Image

        Image.fromarray(screen.pixels()).save(Path(os.environ["LOOK"]) / f"{name}.png")


@pytest.mark.slow
def test_a_slow_sandbox_check_is_announced(screen: Screen, window: Program, folder: Path) -> None:
    (folder / "terrain.glsl").write_text(BUSY, encoding="utf-8")
    window.wait(lambda now: now["trying"] == "terrain.glsl")
    time.sleep(1.5)
    look(screen, "trying")
    (folder / "terrain.glsl").write_text(TERRAIN.replace("level *", "0.9 * level *"), encoding="utf-8")
    window.wait(lambda now: not now["trying"] and now["stage"] == "NONE" and not now["error"])


@pytest.mark.slow
def test_slow_double_click_opens_field_without_losing_keys(
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
def test_a_list_that_cannot_be_drawn_is_left_out(
    screen: Screen, folder: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("BROKEN", "1")
    window = opened(screen, folder)
    try:
        first = window.now()["picture"]
        (folder / "terrain.glsl").write_text(TERRAIN.replace("sin", "sine"), encoding="utf-8")
        window.wait(lambda now: now["error"] and any("list of errors failed" in n for n in now["notices"]))
        time.sleep(0.5)
        look(screen, "left-out")
        (folder / "terrain.glsl").write_text(TERRAIN.replace("0.3", "0.4"), encoding="utf-8")
        window.wait(lambda now: not now["error"] and now["picture"] != first)
        assert window.complaint().count("Traceback") == 1, "the terminal shows it once"
    finally:
        window.close()


@pytest.mark.slow
def test_a_bomb_costs_the_window_nothing(screen: Screen, folder: Path) -> None:
    (folder / "sketch.toml").write_text(
        SKETCH.replace("./terrain", "generation/heightmap").replace(
            "[view]", 'set = { elevation = "terrain.npz" }\n[view]'
        ),
        encoding="utf-8",
    )
    np.savez_compressed(folder / "terrain.npz", elevation=np.eye(65, dtype=np.float32))
    window = opened(screen, folder)
    try:
        first, before = window.now()["picture"], most_memory(window)
        npz(folder / "terrain.npz")
        window.wait(lambda now: "would become 1024 MiB" in now["error"])
        look(screen, "bomb")
        screen.do("mousemove", 600, 100, "click", 4)  # nearer: the picture is not drawn with what failed
        time.sleep(1.0)
        assert window.now()["picture"] == first, "the last good picture stays"
        assert most_memory(window) - before < 200 * 2**20
        before = forget_most_memory(window)
        with (folder / "terrain.npy").open("wb") as file:  # 512 MiB, all of it holes: read in turn
            np.lib.format.write_array_header_1_0(
                file, {"descr": "<f8", "fortran_order": False, "shape": (8192, 8192)}
            )
            file.truncate(file.tell() + 8 * 8192**2)
        text = (folder / "sketch.toml").read_text(encoding="utf-8")
        (folder / "sketch.toml").write_text(text.replace("terrain.npz", "terrain.npy"), encoding="utf-8")
        window.wait(lambda now: not now["error"] and now["picture"] != first)
        # It is read as a terrain of 4097 x 4097 texels: sums of float64, 128 MiB. A band has 2^22 texels: 32
        # MiB as they are in the file, 16 as float32, 32 as float64, 32 of the band before, 8 that say where
        # there is no data, and 8 of what is summed across: 256. Then that terrain is brought to the sketch's
        # 65 x 65: 64 as float32, 64 from 0 to 1 and 128 as float64: 256. The window's frames have the rest.
        assert most_memory(window) - before < 300 * 2**20
    finally:
        window.close()


def forget_most_memory(window: Program) -> int:
    """Count the most memory again from here on; return what there is now [bytes]."""
    Path(f"/proc/{window.process.pid}/clear_refs").write_text("5")
    return most_memory(window)


def most_memory(window: Program) -> int:
    """Return the most memory that a window has had so far [bytes]."""
    status = Path(f"/proc/{window.process.pid}/status").read_text()
    return int(status.partition("VmHWM:")[2].split()[0]) * 1024


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


@pytest.mark.slow
def test_the_folder_may_be_deleted_whole(window: Program, folder: Path) -> None:
    shutil.rmtree(folder)
    window.wait(lambda now: "gone with its folder" in now["error"])
