"""Saves during a flight: tried first, handed over when good, else reported while the last good one stays."""

from __future__ import annotations

import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.engine.sandbox import SandboxReport, TrySketch
from playground.errors import ShaderError
from playground.flight.window import SaveFollower
from playground.sketch.assign import values_of
from playground.sketch.model import Sketch

from ..loading import load

TERRAIN = """// terrain.glsl -- a plain
#pragma kernel(output = "height:r32f")
uniform ivec2 part = ivec2(0); //! Which
uniform float level = 0.25; //! slider(0, 4) How high
float kernel(ivec2 texel) { return level; }
"""
SKETCH = 'format = 1\nsize = 17\n[[pass]]\nname = "height"\nuse = "./terrain"\n[view]\nuse = "view/terrain"\n'


class Tried:
    """Answers as a test says, and stores its requests."""

    def __init__(self) -> None:
        self.requests: list[Sketch] = []
        self.answer = SandboxReport(True)

    def submit(self, request: TrySketch) -> None:
        self.requests.append(request.sketch)

    def poll(self) -> SandboxReport | None:
        return self.answer


@pytest.fixture
def tried() -> Tried:
    return Tried()


@pytest.fixture
def saves(tmp_path: Path, tried: Tried) -> Iterator[SaveFollower]:
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    values = {"height.level": 1.0}
    shown = load(tmp_path).with_values(values)
    with SaveFollower(tmp_path / "sketch.toml", shown, values, tried, "auto", lambda: None) as made:
        yield made


def until(saves: SaveFollower, what: str) -> Sketch | None:
    """Go on until there is a sketch, or an error with these words."""
    end = time.monotonic() + 20.0
    while time.monotonic() < end:
        sketch = saves.update()
        if sketch is not None or (what and what in str(saves.error or "")):
            return sketch
        time.sleep(0.01)
    pytest.fail(f"neither a sketch nor '{what}': {saves.error}")


def test_a_good_save_is_tried_and_handed_over_with_what_was_set(
    saves: SaveFollower, tried: Tried, tmp_path: Path
) -> None:
    (tmp_path / "terrain.glsl").write_text(
        TERRAIN.replace("return level", "return 0.5 * level"), encoding="utf-8"
    )
    result = until(saves, "")
    assert result is not None and tried.requests == [result] and saves.error is None
    assert values_of(result)["height.level"] == 1.0
    assert saves.update() is None, "once"


def test_a_wrong_one_is_reported_and_the_next_good_one_clears_it(saves: SaveFollower, tmp_path: Path) -> None:
    (tmp_path / "sketch.toml").write_text(SKETCH.replace("./terrain", "./lnd"), encoding="utf-8")
    assert until(saves, "lnd") is None
    assert "sketch.toml" in str(saves.error)
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    assert until(saves, "") is not None and saves.error is None


def test_what_fails_in_the_sandbox_is_not_handed_over(
    saves: SaveFollower, tried: Tried, tmp_path: Path
) -> None:
    tried.answer = SandboxReport(False, ShaderError("no such name", file="terrain.glsl", line=5))
    (tmp_path / "terrain.glsl").write_text(TERRAIN.replace("return level", "return levl"), encoding="utf-8")
    assert until(saves, "no such name") is None
    tried.answer = SandboxReport(True)
    (tmp_path / "terrain.glsl").write_text(TERRAIN, encoding="utf-8")
    assert until(saves, "") is not None and saves.error is None


def test_what_cannot_be_flown_over_after_all_is_reported(saves: SaveFollower, tmp_path: Path) -> None:
    (tmp_path / "terrain.glsl").write_text(TERRAIN.replace("0.25", "0.75"), encoding="utf-8")
    assert until(saves, "") is not None
    saves.refuse(ShaderError("it has no parts"))
    assert "it has no parts" in str(saves.error)
