"""A save that shows nothing, for a companion stands in for the kernel, is told of."""

from __future__ import annotations

import shutil
from pathlib import Path

import pytest

from playground.engine.engine import Engine
from playground.live.session import Session
from playground.paths import GLSL
from playground.sketch.load import load
from playground.sketch.stand_ins import stand_ins

SKETCH = """format = 1
size = 33
[[pass]]
name = "height"
use = "./diamond_square"
[view]
use = "view/map"
inputs = { shown = "height" }
"""
BEFORE, AFTER = "number * share * smoothing", "number * share * share * smoothing"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A sketch with diamond-square of its own, companion and all."""
    generation = GLSL / "generation"
    shutil.copytree(generation / "diamond_square", tmp_path / "diamond_square")
    for suffix in (".toml", ".comp"):
        text = (generation / f"diamond_square{suffix}").read_text(encoding="utf-8")
        text = text.replace('"generation/diamond_square/', '"./diamond_square/')
        (tmp_path / f"diamond_square{suffix}").write_text(text, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    return tmp_path


def change(path: Path, before: str, after: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after), encoding="utf-8")


def test_the_kernel_s_change_is_named_with_what_stands_in(folder: Path):
    old = load(folder)
    assert stand_ins(old, load(folder)) == []
    change(folder / "diamond_square/raw.glsl", BEFORE, AFTER)
    (sentence,) = stand_ins(old, load(folder))
    assert "diamond_square.comp stands in for what was saved" in sentence


def test_a_change_of_the_companion_too_needs_no_word(folder: Path):
    old = load(folder)
    change(folder / "diamond_square/raw.glsl", BEFORE, AFTER)
    change(folder / "diamond_square.comp", "#pragma compute", "// changed as well\n#pragma compute")
    change(folder / "diamond_square.comp", "void main()", "float unused = 1.0;\nvoid main()")
    assert stand_ins(old, load(folder)) == []


@pytest.mark.parametrize(("driver", "told"), [("auto", 1), ("fragment", 0)])
def test_a_session_says_it(folder: Path, ctx, driver: str, told: int):
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx, driver=driver) as engine:
        session = Session(engine, folder)
        session.frame((64, 48))
        session.notes.clear()
        change(folder / "diamond_square/raw.glsl", BEFORE, AFTER)
        session.reload()
        session.frame((64, 48))
        assert sum("stands in" in note for note in session.notes) == told
        session.release()
