"""A window opens where it was the last time, and its title says which sketch is in it."""

from __future__ import annotations

import os
import re
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.studio.app import title_of

from .screen import LIMIT, ON_LINUX, Program, Screen

RUN = """
import sys
from pathlib import Path
from playground.studio import app
draw_frame = app.Live._draw_frame
def opened(live):
    draw_frame(live)
    other = Path(sys.argv[2])
    if other.is_file() and live.session.path != other:
        live.bench.commands.open(other)
app.Live._draw_frame = opened
sys.exit(app.run(sys.argv[1], time_limit=300))
"""
SKETCH = """format = 1
size = 33
[[pass]]
name = "height"
use = "generation/diamond_square"
"""


def test_a_sketch_in_a_folder_is_called_by_its_folder(tmp_path: Path) -> None:
    assert title_of(tmp_path / "hills" / "sketch.toml") == "hills – terrain shader playground"
    assert title_of(tmp_path / "hills" / "valley.toml") == "valley – terrain shader playground"
    assert title_of(tmp_path / "terrain.glsl") == "terrain – terrain shader playground"


SCREEN = 1000, 700  # [pixels]


class Windows:
    """One window after another on a sketch, as X sees them."""

    def __init__(self, screen: Screen, folder: Path) -> None:
        self.screen, self.folder = screen, folder
        (folder / "hills").mkdir()
        (folder / "hills" / "sketch.toml").write_text(SKETCH, encoding="utf-8")
        self.other = folder / "valley.toml"
        self.program = self.open()

    def open(self) -> Program:
        (self.folder / "status.jsonl").unlink(missing_ok=True)
        command = [sys.executable, "-c", RUN, str(self.folder / "hills"), str(self.other)]
        self.program = Program(self.screen, self.folder, command, self.folder)
        self.program.wait(lambda now: now["draws"] > 0)
        return self.program

    def ask(self, *words: str) -> str:
        environment = {**os.environ, "DISPLAY": self.screen.display}
        return subprocess.check_output(
            [self.screen.xdotool, *words], env=environment, text=True, timeout=180
        ).strip()

    def id(self) -> str:
        return self.ask("search", "--sync", "--onlyvisible", "--name", "terrain shader playground").split()[0]

    def geometry(self) -> tuple[int, ...]:
        result = self.ask("getwindowgeometry", "--shell", self.id())
        return tuple(int(n) for n in re.findall(r"(?:X|Y|WIDTH|HEIGHT)=(-?\d+)", result))

    def end(self) -> None:
        self.screen.do("key", "ctrl+q")
        assert self.program.ended() == 0
        self.program.close()


@pytest.fixture
def windows(screen: Screen, tmp_path: Path) -> Iterator[Windows]:
    made = Windows(screen, tmp_path)
    yield made
    made.program.close()


@pytest.mark.slow
@pytest.mark.live
@ON_LINUX[1]
def test_it_opens_where_it_was_and_follows_its_sketch(windows: Windows) -> None:
    assert windows.ask("getwindowname", windows.id()) == "hills – terrain shader playground"
    windows.ask("windowsize", "--sync", windows.id(), "620", "410")
    windows.ask("windowmove", "--sync", windows.id(), "210", "150")
    assert soon(lambda: windows.geometry() == (210, 150, 620, 410))
    windows.end()
    windows.open()
    assert windows.geometry() == (210, 150, 620, 410)
    windows.ask("windowmove", "--sync", windows.id(), "900", "600")  # most of it beyond the screen
    windows.end()
    windows.open()
    assert windows.geometry() == (1000 - 620, 700 - 410, 620, 410)
    windows.other.write_text(SKETCH, encoding="utf-8")
    assert soon(lambda: windows.ask("getwindowname", windows.id()) == "valley – terrain shader playground")


def soon(is_so) -> bool:
    end = time.monotonic() + LIMIT
    while not (result := is_so()) and time.monotonic() < end:
        time.sleep(0.1)
    return result
