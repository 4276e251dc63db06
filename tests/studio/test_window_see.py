"""What is shown around the picture, as a person meets it: a real X server, a mouse and keys by xdotool."""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from ..sketch_texts import map_of, passes
from .screen import ON_LINUX, Program, Screen, script
from .test_window_panel import TERRAIN

WIDTH, HEIGHT = 900, 560
PANEL = 330
SKETCH = (
    """format = 1
title = "Hills"
size = [65, 33]
extent = [1000.0, 500.0]
relief = 200.0
"""
    + passes(height=("./terrain", "set = { level = 0.75 }"))
    + map_of("height")
    + """[[keyframe]]
time = 1.0
set = { "view.lowest" = 0.0 }
[[keyframe]]
time = 2.0
set = { "view.lowest" = -1.0 }
"""
)

pytestmark = ON_LINUX


SCREEN = WIDTH + 50, HEIGHT + 50  # [pixels]


@pytest.fixture
def program(screen: Screen, tmp_path: Path) -> Iterator[Program]:
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    run = script((WIDTH, HEIGHT))
    made = Program(screen, tmp_path, [sys.executable, "-c", run, str(tmp_path)], tmp_path)
    made.wait(lambda now: now["draws"] > 0)
    yield made
    made.close()


def picture(screen: Screen) -> NDArray[np.uint8]:
    """Return the part of the screen that shows the terrain, between what lies over it above and below."""
    return screen.pixels()[70 : HEIGHT - 60, PANEL + 4 : WIDTH - 4]


def until(program: Program, done: object) -> None:
    assert callable(done)
    program.wait(lambda _: done())


@pytest.mark.slow
def test_all_of_it_by_keys_and_by_mouse(screen: Screen, program: Program) -> None:
    screen.do("mousemove", 600, 300, "key", "space", "key", "0")
    program.wait(lambda now: not now["playing"])
    screen.do("mousemove", 100, HEIGHT - 100, "mousemove", 620, 300)
    rested = program.now()["picture"]
    before = picture(screen)

    # I: a box at the mouse; nothing is drawn for it.
    draws = program.now()["draws"]
    screen.do("key", "i")
    until(program, lambda: (picture(screen) != before).any(axis=2).sum() > 4000)
    assert program.now()["draws"] == draws
    screen.do("key", "i")
    until(program, lambda: (picture(screen) == before).all())

    # G: the passes over the picture, and away.
    screen.do("key", "g")
    until(program, lambda: (picture(screen) != before).any(axis=2).mean() > 0.3)
    screen.do("key", "g")
    until(program, lambda: (picture(screen) == before).all())

    # A: the left half stays what it was while the file makes another of the right one.
    screen.do("key", "a")
    folder = program.status.parent
    (folder / "sketch.toml").write_text(SKETCH.replace("0.75", "0.25"), encoding="utf-8")
    program.wait(lambda now: now["picture"] != rested)
    middle = before.shape[1] // 2

    def halves() -> bool:
        now = picture(screen)
        left = (now[:, : middle - 40] == before[:, : middle - 40]).all()
        return bool(left and (now[:, middle + 40 :] != before[:, middle + 40 :]).any(axis=2).mean() > 0.3)

    until(program, halves)
    line = (PANEL + WIDTH) // 2
    screen.do("mousemove", line, 400, "sleep", 0.3, "mousedown", 1, "sleep", 0.3)
    screen.do("mousemove", line + 60, 400, "sleep", 0.3, "mousemove", line + 120, 400, "sleep", 0.3)
    screen.do("mouseup", 1, "mousemove", 620, 300)  # the mouse itself is on the screen as well
    moved = middle + 80
    until(program, lambda: (picture(screen)[:, :moved] == before[:, :moved]).all())
    screen.do("key", "a")

    # The bar of time: a click there goes to that moment, and a full stop a picture on.
    now = program.wait(lambda now: now["stage"] == "NONE")["picture"]
    screen.do("mousemove", WIDTH - 40, HEIGHT - 20, "sleep", 0.3, "mousedown", 1, "sleep", 0.3, "mouseup", 1)
    late = program.wait(lambda result: result["picture"] != now)["picture"]
    screen.do("mousemove", 620, 300, "type", ",")
    program.wait(lambda result: result["picture"] != late)
    screen.do("key", "ctrl+q")
    assert program.ended() == 0, program.complaint()
