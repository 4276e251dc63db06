"""A saved default that changes nothing visible is reported with what overrides it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.sketch.templates import make_sketch
from playground.studio.session import Session

SIZE = (32, 18)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    made = make_sketch(tmp_path / "hills")
    change(made / "sketch.toml", "size   = 513", "size = 33")
    return made


def change(path: Path, before: str, after: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after), encoding="utf-8")


def saved(session: Session) -> tuple[np.ndarray, list[str]]:
    session.notes.clear()
    session.drafts.reload()
    session.frame(SIZE)
    frame = session.read()
    assert frame is not None and session.error is None
    return frame.array, list(session.notes)


@pytest.mark.parametrize(
    "edit",
    [
        ("frequency = 5.0", "frequency = 9.0"),
        ("roughness = 0.42", "roughness = 0.6"),
        ("ridges    = 0.6", "ridges = 0.1"),
    ],
)
def test_the_first_edit_that_the_readme_proposes_shows(any_engine: Engine, folder: Path, edit):
    """Step 1: in hills/my_land.glsl, change a number and save; the terrain in the window changes."""
    session = Session(any_engine, folder)
    before, _ = saved(session)
    change(folder / "my_land.glsl", *edit)
    after, notes = saved(session)
    assert notes == [] and np.abs(after.astype(int) - before).mean() > 1
    session.release()


@pytest.mark.slow
def test_a_set_of_the_sketch_is_named_with_its_line(any_engine: Engine, folder: Path):
    change(folder / "sketch.toml", 'use  = "./my_land"', 'use  = "./my_land"\nset  = { frequency = 5 }')
    session = Session(any_engine, folder)
    before, _ = saved(session)
    change(folder / "my_land.glsl", "frequency = 5.0", "frequency = 9.0")
    after, notes = saved(session)
    np.testing.assert_array_equal(after, before)
    assert notes == [f"height.frequency: the default is 9; {folder}/sketch.toml:15 sets 5"]
    assert saved(session)[1] == []
    session.release()


@pytest.mark.slow
def test_what_the_panel_sets_is_named_too(any_engine: Engine, folder: Path):
    session = Session(any_engine, folder)
    saved(session)
    session.drafts.set("height.frequency", 3.0)
    change(folder / "my_land.glsl", "frequency = 5.0", "frequency = 9.0")
    assert saved(session)[1] == ["height.frequency: the default is 9; the panel sets 3"]
    session.release()
