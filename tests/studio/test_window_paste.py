"""A shader's text on the real clipboard opens in a real window, and so does one from standard input."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import pytest

from .screen import ON_LINUX, ROOT, Program, Screen, script

pytestmark = [*ON_LINUX, pytest.mark.slow, pytest.mark.room("dialects")]

SCREEN = 900, 600  # [pixels]
FILES = {"first.frag": "void main() { gl_FragColor = vec4(0.0, 0.5, 0.0, 1.0); }\n"}
SHADER = "// Half red\nvoid mainImage(out vec4 c, in vec2 p) { c = vec4(0.5, 0.0, 0.0, 1.0); }\n"
HOLDS = """
import sys
import imgui_bundle
import glfw
glfw.init()
glfw.window_hint(glfw.VISIBLE, False)
window = glfw.create_window(8, 8, "clipboard", None, None)
glfw.set_clipboard_string(window, sys.argv[1])
print("there", flush=True)
while True:
    glfw.wait_events_timeout(1.0)
"""
MIDDLE = 700, 300


@pytest.fixture
def clipboard(screen: Screen) -> Iterator[None]:
    """Hold the text on the screen's clipboard, as another program does."""
    environment = {**os.environ, "DISPLAY": screen.display}
    holder = subprocess.Popen(
        [sys.executable, "-c", HOLDS, SHADER], env=environment, stdout=subprocess.PIPE, text=True
    )
    assert holder.stdout is not None and holder.stdout.readline() == "there\n"
    yield
    holder.kill()
    holder.wait(10)
    holder.stdout.close()


@pytest.mark.usefixtures("clipboard")
def test_pasted_text_opens_in_window_and_first_sketch_returns(screen: Screen, folder: Path) -> None:
    command = [sys.executable, "-c", script((800, 500)), str(folder / "first.frag")]
    program = Program(screen, folder, command, folder)
    try:
        first = program.wait(lambda now: now["draws"] > 0)["picture"]
        screen.do("mousemove", *MIDDLE, "key", "ctrl+v")
        program.wait(lambda now: any("pasted as half_red.frag" in text for text in now["notices"]))
        second = program.wait(lambda now: now["picture"] != first and not now["error"])["picture"]
        assert (folder / "half_red.frag").read_text("utf-8") == SHADER
        assert tuple(screen.pixels()[450, 600]) == (128, 0, 0)
        screen.do("key", "BackSpace")
        program.wait(lambda now: now["picture"] == first)
        screen.do("key", "shift+BackSpace")
        program.wait(lambda now: now["picture"] == second)
        screen.do("key", "ctrl+q")
        assert program.ended() == 0, program.complaint()
    finally:
        program.close()


@pytest.mark.usefixtures("clipboard")
def test_the_clipboard_is_read_before_there_is_a_window(screen: Screen) -> None:
    read = "from playground.studio.window import clipboard_text\nprint(clipboard_text(), end='')"
    environment = {**os.environ, "DISPLAY": screen.display, "PYTHONPATH": str(ROOT)}
    result = subprocess.run(
        [sys.executable, "-c", read], env=environment, capture_output=True, text=True, timeout=60, check=True
    )
    assert result.stdout == SHADER


def test_a_text_from_standard_input_opens(screen: Screen, folder: Path) -> None:
    file = folder / "given.txt"
    file.write_text(SHADER, "utf-8")
    command = f"exec '{sys.executable}' -m playground live - --size 800x500 < given.txt"
    program = Program(screen, folder, ["sh", "-c", command], folder)
    try:
        program.wait(lambda now: now["draws"] > 0)
        assert "standard input is kept as half_red.frag" in program.complaint()
        screen.do("mousemove", *MIDDLE, "key", "ctrl+q")
        assert program.ended() == 0, program.complaint()
    finally:
        program.close()
