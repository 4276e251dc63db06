"""The panel as a person meets it: a real X server, a mouse and keys by xdotool, a file that is saved."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from ..sketch_texts import map_of, passes
from .screen import ON_LINUX, Program, Screen, script

WIDTH, HEIGHT = 800, 500
LEVEL = 200, 243  # the first parameter's slider, at scale 1
TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high
float kernel(ivec2 texel) { return level * (0.5 + 0.5 * sin(9.0 * float(texel.x) / float(size.x))); }
"""
SKETCH = (
    """format = 1  # ours
title = "Hills"
size = 65
extent = 1000.0
relief = 200.0
"""
    + passes(height=("./terrain", "set = { level = 0.75 }   # by eye"))
    + map_of("height")
)

pytestmark = ON_LINUX


SCREEN = WIDTH + 200, HEIGHT + 100  # [pixels]
FILES = {"terrain.glsl": TERRAIN, "sketch.toml": SKETCH}


def opened(screen: Screen, folder: Path, size: object) -> Program:
    run = script(size)
    program = Program(screen, folder, [sys.executable, "-c", run, str(folder)], folder)
    program.wait(lambda now: now["draws"] > 0)
    return program


@pytest.mark.slow
def test_a_value_is_typed_undone_and_saved(screen: Screen, folder: Path) -> None:
    program = opened(screen, folder, (WIDTH, HEIGHT))
    try:
        first = program.now()["picture"]
        screen.do(
            "mousemove", *LEVEL, "keydown", "ctrl", "sleep", 0.5, "click", 1, "sleep", 0.5, "keyup", "ctrl"
        )
        program.wait(lambda now: now["takes_text"])
        screen.do("type", "--delay", 200, "1/4")
        screen.do("key", "Return")
        low = program.wait(lambda now: now["picture"] != first)["picture"]

        screen.do("mousemove", WIDTH - 100, 200, "key", "ctrl+s")
        program.wait(lambda now: any("saved 1 value" in text for text in now["notices"]))
        file = folder / "sketch.toml"
        assert file.read_text(encoding="utf-8") == SKETCH.replace("0.75", "0.25")
        reloaded = program.wait(lambda now: now["stage"] == "NONE")
        assert reloaded["picture"] == low and not reloaded["error"]

        screen.do("key", "ctrl+z")
        program.wait(lambda now: now["picture"] == first)
        screen.do("key", "ctrl+shift+z")
        program.wait(lambda now: now["picture"] == low)
        screen.do("key", "ctrl+z")
        program.wait(lambda now: now["picture"] == first)
        screen.do("key", "ctrl+s")
        program.wait(lambda now: file.read_text(encoding="utf-8") == SKETCH)
        screen.do("key", "ctrl+q")
        assert program.ended() == 0, program.complaint()
    finally:
        program.close()


@pytest.mark.slow
def test_it_fills_the_screen_and_comes_back(screen: Screen, folder: Path) -> None:
    program = opened(screen, folder, (WIDTH, HEIGHT))

    def full() -> bool:
        return bool(screen.pixels()[HEIGHT + 50 :, :200].any())

    try:
        assert not full()
        for filled in (True, False):
            before = program.now()["picture"]
            screen.do("mousemove", 600, 300, "key", "F11")
            program.wait(lambda now, old=before: now["picture"] != old)
            program.wait(lambda now, so=filled: full() == so)
        screen.do("mousemove", 600, 300, "key", "ctrl+q")
        assert program.ended() == 0, program.complaint()
    finally:
        program.close()
