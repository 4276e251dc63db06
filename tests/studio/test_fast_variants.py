"""In a live session an edit of the plain text always shows, and one note says what does not run."""

from __future__ import annotations

import shutil
from pathlib import Path

import numpy as np
import pytest

from playground.engine.engine import Engine
from playground.paths import GLSL
from playground.sketch.variants import NAME
from playground.studio.session import Session

from ..sketch_texts import map_of_height
from ..variants import trust

SKETCH = "format = 1\nsize = 33\n" + map_of_height("./diamond_square")
BEFORE, AFTER = "number * share * smoothing", "number * share * share * smoothing"
SIZE = (64, 48)


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A sketch with diamond-square of its own, its compute variant verified."""
    generation = GLSL / "generation"
    shutil.copytree(generation / "diamond_square", tmp_path / "diamond_square")
    for suffix in (".toml", ".comp"):
        text = (generation / f"diamond_square{suffix}").read_text(encoding="utf-8")
        text = text.replace('"generation/diamond_square/', '"./diamond_square/')
        (tmp_path / f"diamond_square{suffix}").write_text(text, encoding="utf-8")
    (tmp_path / "sketch.toml").write_text(SKETCH, encoding="utf-8")
    trust(tmp_path)
    return tmp_path


@pytest.fixture
def session(ctx, folder):
    if ctx.version_code < 430:
        pytest.skip("this context has no compute shaders")
    with Engine(ctx) as engine:
        made = Session(engine, folder)
        made.frame(SIZE)
        yield made
        made.release()


def change(path: Path, before: str, after: str) -> None:
    text = path.read_text(encoding="utf-8")
    assert before in text
    path.write_text(text.replace(before, after), encoding="utf-8")


def picture(session: Session) -> np.ndarray:
    session.frame(SIZE)
    frame = session.read()
    assert frame is not None and session.error is None
    return frame.array


def saved(session: Session) -> np.ndarray:
    session.notes.clear()
    session.drafts.reload()
    return picture(session)


def runs_fast(session: Session) -> bool:
    return session.plan is not None and session.plan.step("height") is not None


def test_a_save_of_the_plain_text_shows_and_is_reported_once(session, folder):
    before = picture(session)
    assert runs_fast(session) and not session.notes
    change(folder / "diamond_square/raw.glsl", BEFORE, AFTER)
    after = saved(session)
    assert (after != before).any() and not runs_fast(session)
    (note,) = session.notes
    assert "diamond_square.comp is left out, the plain form runs" in note
    change(folder / "diamond_square/raw.glsl", "// end: height", "// more\n// end: height")
    saved(session)
    assert not session.notes, "what was reported before is not reported again"
    change(folder / "diamond_square/raw.glsl", AFTER, BEFORE)
    np.testing.assert_array_equal(saved(session), before)
    assert runs_fast(session) and not session.notes
    change(folder / "diamond_square/raw.glsl", BEFORE, AFTER)
    saved(session)
    assert len(session.notes) == 1, "it ran again in between"


def test_what_is_wrong_from_the_beginning_is_reported(ctx, folder):
    (folder / NAME).unlink()
    with Engine(ctx) as engine:
        session = Session(engine, folder)
        session.frame(SIZE)
        assert len([note for note in session.notes if "was never verified" in note]) == 1
        session.release()


def test_a_record_that_is_renewed_is_taken_up(session, folder):
    change(folder / "diamond_square/raw.glsl", BEFORE, AFTER)
    saved(session)
    assert not runs_fast(session)
    trust(folder)
    saved(session)
    assert runs_fast(session)
    assert folder / NAME in session.drafts.files, "so that the window follows it"


def test_the_switch_runs_the_plain_form_and_outlives_a_save(session, folder):
    before = picture(session)
    session.drafts.run_plain(True)
    assert np.abs(picture(session).astype(int) - before).max() <= 1
    assert not runs_fast(session) and not session.notes
    change(folder / "sketch.toml", "size = 33", "size = 65")
    saved(session)
    assert not runs_fast(session) and session.plan is not None and session.plan.terrain.size == (65, 65)
    session.drafts.run_plain(False)
    picture(session)
    assert runs_fast(session)


def test_plain_from_the_beginning(ctx, folder):
    with Engine(ctx) as engine:
        session = Session(engine, folder, plain=True)
        session.frame(SIZE)
        assert not runs_fast(session) and not session.notes
        session.release()


def test_a_text_that_replaces_a_file_shows_as_well(session, folder):
    before = picture(session)
    path = folder / "diamond_square/raw.glsl"
    session.drafts.read_as({str(path): path.read_text(encoding="utf-8").replace(BEFORE, AFTER)})
    assert (picture(session) != before).any() and not runs_fast(session)
    assert len(session.notes) == 1
    session.drafts.read_as({})
    np.testing.assert_array_equal(picture(session), before)
    assert runs_fast(session)
