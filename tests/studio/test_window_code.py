"""The code pane in a real window: a kernel is typed, broken, repaired, saved, and a name in it changed."""

from __future__ import annotations

import sys
import time
from pathlib import Path

import pytest

from .screen import HILLS, ON_LINUX, Program, Screen, script

pytestmark = [*ON_LINUX, pytest.mark.slow]
SCREEN = 1280, 720
KERNEL = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
uniform float level = 0.5; //! slider(0, 1) How high the hills are
float kernel(ivec2 texel) {
    return level;
}
"""


def window_on(screen: Screen, folder: Path) -> Program:
    command = [sys.executable, "-c", script(SCREEN), str(folder / "sketch.toml")]
    return Program(screen, folder, command, folder, code=True)


def test_a_kernel_is_typed_broken_repaired_and_renamed(screen: Screen, tmp_path: Path) -> None:
    file = tmp_path / "terrain.glsl"
    file.write_text(KERNEL, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(HILLS, encoding="utf-8")
    window = window_on(screen, tmp_path)
    try:
        first = window.wait(lambda now: now["picture"] and not now["error"])["picture"]
        screen.do("mousemove", 1000, 300, "click", 1)
        window.wait(lambda now: now["typing"] == ["terrain.glsl"])
        screen.do("key", "ctrl+Home")
        screen.do("key", "--delay", 30, "Down", "Down", "Down", "Down", "End", "Left")
        screen.do("type", "--delay", 40, " + 0.3 * sin(0.2 * float(texel.x))")
        typed = time.monotonic()
        drawn = window.wait(lambda now: now["picture"] != first and not now["error"])
        print(f"drawn {time.monotonic() - typed:.2f} s after the last letter; {drawn['reload_ms']} ms of it")
        assert file.read_text(encoding="utf-8") == KERNEL and drawn["unsaved"] == ["terrain.glsl"]
        screen.do("type", "--delay", 40, " + nothing")
        broken = window.wait(lambda now: now["error"])
        assert ":5:" in broken["error"] and broken["picture"] == drawn["picture"], "the last good one stays"
        screen.do("key", "ctrl+z", "ctrl+z")
        window.wait(lambda now: not now["error"] and now["stage"] == "NONE")
        screen.do("key", "ctrl+s")
        window.wait(lambda now: not now["unsaved"])
        assert "+ 0.3 * sin(0.2 * float(texel.x));" in file.read_text(encoding="utf-8")
        screen.do("key", "ctrl+Home")
        screen.do("key", "--delay", 30, "Down", "Down", *["Right"] * 16, "F2")
        time.sleep(0.5)
        screen.do("type", "--delay", 40, "rise")
        screen.do("key", "Return")
        window.wait(lambda now: now["unsaved"] and not now["error"])
        screen.do("key", "ctrl+s")
        window.wait(lambda now: not now["unsaved"])
        saved = file.read_text(encoding="utf-8")
        assert "float rise = 0.5;" in saved and "return rise + 0.3" in saved and "level" not in saved
        screen.do("key", "Escape")
        window.wait(lambda now: not now["typing"])
        screen.do("key", "m")
        window.wait(lambda now: now["map"])
    finally:
        window.close()
