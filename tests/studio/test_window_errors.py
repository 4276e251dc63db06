"""Errors in a real window: the user's editor is started at the line, the one in the window mends the file."""

from __future__ import annotations

import sys
from pathlib import Path

import pytest

from ..sketch_texts import map_of_height
from .screen import ON_LINUX, Program, Screen, script

RUN = script((800, 600))
TERRAIN = """// terrain.glsl -- hills
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) {
    return sin(0.3 * float(texel.x));
}
"""
SKETCH = "format = 1\nsize = 17\n" + map_of_height()

pytestmark = ON_LINUX


SCREEN = 800, 600  # [pixels]


def opened(screen: Screen, folder: Path) -> Program:
    (folder / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    (folder / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    made = Program(screen, folder, [sys.executable, "-c", RUN, str(folder)], folder)
    made.wait(lambda now: now["draws"] > 0)
    screen.do("mousemove", 500, 100)
    return made


@pytest.mark.slow
def test_a_key_starts_the_editor_at_the_line(
    screen: Screen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    value = tmp_path / "opened.txt"
    script = tmp_path / "editor.py"
    script.write_text("import pathlib, sys\npathlib.Path(sys.argv[1]).write_text('|'.join(sys.argv[2:]))\n")
    command = f"{sys.executable} {script} {value} {{file}} {{line}} {{column}}"
    monkeypatch.setenv("PLAYGROUND_EDITOR", command)
    window = opened(screen, tmp_path)
    try:
        (tmp_path / "terrain.glsl").write_text(TERRAIN.replace("sin", "sine"), encoding="utf-8")
        window.wait(lambda now: now["error"])
        screen.do("key", "e")
        window.wait(lambda _: value.exists() and value.read_text())
        assert value.read_text() == f"{tmp_path / 'terrain.glsl'}|4|12"
        window.wait(lambda now: any("opened terrain.glsl in" in text for text in now["notices"]))
    finally:
        window.close()


@pytest.mark.slow
def test_the_editor_in_the_window_fixes_the_file(
    screen: Screen, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("PLAYGROUND_EDITOR", "builtin")
    window = opened(screen, tmp_path)
    try:
        good = window.now()["picture"]
        (tmp_path / "terrain.glsl").write_text(TERRAIN.replace("sin(", "in("), encoding="utf-8")
        window.wait(lambda now: now["error"])
        screen.do("key", "e")
        window.wait(lambda now: now["typing"] == ["terrain.glsl"])
        screen.do("key", "s")  # the cursor is before "in"
        window.wait(lambda now: now["unsaved"] == ["terrain.glsl"])
        screen.do("keydown", "ctrl", "sleep", 0.3, "key", "s", "sleep", 0.3, "keyup", "ctrl")
        window.wait(lambda now: not now["error"] and now["picture"] == good)
        assert (tmp_path / "terrain.glsl").read_text(encoding="utf-8") == TERRAIN
    finally:
        window.close()
