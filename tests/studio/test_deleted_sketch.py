"""Every error that reaches the window has a file; a sketch whose file is gone says so, and comes back."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from playground import errors
from playground.engine.engine import Engine
from playground.engine.sandbox import SandboxReport
from playground.errors import PlaygroundError
from playground.studio.problems.problems import Problems
from playground.studio.session import Session

from .panel_desk import Bare, errors_of
from .screen import ROOT
from .session_desk import FakeSandbox, OpenSession
from .test_session import SLOPE


def family(kind: type[PlaygroundError] = PlaygroundError) -> list[type[PlaygroundError]]:
    """Return every kind of error there is."""
    return [kind, *(result for below in kind.__subclasses__() for result in family(below))]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    home = tmp_path / "my-terrain"
    (home / "inc").mkdir(parents=True)
    for name, text in SLOPE.items():
        (home / name).write_text(text, encoding="utf-8")
    return home


def test_there_are_many_kinds_of_errors() -> None:
    assert {errors.SandboxCrash, errors.OpenGLFault, errors.ParameterError, errors.DataError} <= set(family())


@pytest.mark.parametrize("kind", [*family(), RuntimeError, MemoryError], ids=lambda kind: kind.__name__)
def test_every_error_without_file_is_shown_at_sketch_file(
    bare: Bare, kind: type[Exception], monkeypatch: pytest.MonkeyPatch
) -> None:
    session, raised = bare.session, kind("this went wrong")

    def refuse(*_: object, **__: object) -> None:
        raise raised

    monkeypatch.setattr(session.engine, "draw", refuse)
    session.redraw()
    bare.run_frames()
    error = session.error
    assert error is not None and "this went wrong" in str(error)
    if isinstance(raised, PlaygroundError):
        assert type(error) is kind
    bare.bench.problems.take(error)
    area = 330.0, 0.0, 900.0, 720.0
    for _ in range(2):
        bare.run_frames(around=lambda draw: (draw(), errors_of(bare.bench).draw(bare.theme, area)))
    assert {d.file for d in bare.bench.problems.all} == {str(session.path)}
    assert any("sketch.toml" in label for label in bare.places), "the file heads the list"


def test_a_list_that_holds_no_file_is_drawn_all_the_same(bare: Bare) -> None:
    bare.bench.problems.take(PlaygroundError("without a place"))
    area = 330.0, 0.0, 900.0, 720.0
    bare.run_frames(2, around=lambda draw: (draw(), errors_of(bare.bench).draw(bare.theme, area)))
    assert any("no file" in label for label in bare.places)


@pytest.mark.parametrize("kind", family(), ids=lambda kind: kind.__name__)
def test_a_refusal_of_the_sandbox_names_the_sketch(
    folder: Path, open_session: OpenSession, kind: type[PlaygroundError]
) -> None:
    sandbox = FakeSandbox()
    sandbox.answer = SandboxReport(False, kind("refused"))
    session = open_session(folder, sandbox=sandbox)
    session.frame((32, 32))
    if not issubclass(kind, errors.ContextError):  # then the window's own context decides
        assert session.error is not None and session.error.diagnostics[0].file == str(folder / "sketch.toml")


def test_missing_sketch_is_reported_and_resumes_once_restored(folder: Path, any_engine: Engine) -> None:
    session, path = Session(any_engine, folder), folder / "sketch.toml"
    session.frame((32, 32))
    before = session.read()
    path.rename(folder / "aside")
    session.drafts.reload()
    assert session.frame((32, 32)) is not None, "the last good picture stays"
    message = str(session.error)
    assert "the file is gone" in message and str(path) in message and "put it back" in message
    assert "jacksboro" not in message
    (folder / "aside").rename(path)
    session.drafts.reload()
    session.frame((32, 32))
    after = session.read()
    assert session.error is None and before is not None and after is not None
    assert (before.array == after.array).all()
    session.release()


def test_a_folder_that_was_moved_away_says_so(folder: Path, open_session: OpenSession) -> None:
    session = open_session(folder)
    session.frame((32, 32))
    folder.rename(folder.with_name("elsewhere"))
    session.drafts.reload()
    message = str(session.error)
    assert "the file is gone with its folder" in message and str(folder) in message


@pytest.mark.slow
def test_the_current_folder_may_be_deleted_under_a_session(tmp_path: Path) -> None:
    script = """
import os, shutil, sys
from pathlib import Path
from playground.engine.engine import Engine
from playground.engine.context import open_context
from playground.studio.session import Session
from playground.studio.problems.problems import Problems
with Engine(open_context()) as engine:
    session = Session(engine, sys.argv[1])
    session.frame((32, 32))
    shutil.rmtree(Path.cwd())
    session.drafts.reload()
    session.frame((32, 32))
    problems = Problems()
    problems.take(session.error, (), session.sketch)
    print(session.error, session.drafts.files and problems.text())
"""
    home = tmp_path / "here"
    home.mkdir()
    (home / "sketch.toml").write_text(
        SLOPE["sketch.toml"].replace("./terrain", "generation/white_noise"), encoding="utf-8"
    )
    done = subprocess.run(
        [sys.executable, "-c", script, "sketch.toml"],
        cwd=home,
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        capture_output=True,
        text=True,
        timeout=120,
    )
    assert done.returncode == 0, done.stderr
    assert "the file is gone with its folder" in done.stdout


def test_problems_of_no_file_have_a_heading() -> None:
    problems = Problems()
    problems.take(PlaygroundError("without a place"))
    assert [file for file, _ in problems.by_file()] == [""]
