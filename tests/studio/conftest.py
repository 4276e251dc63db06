"""What tests of the window share: a sketch's folder, a panel or a session on it, a remote, a screen."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path
from typing import Any

import pytest

from playground.engine.engine import Engine
from playground.studio.session import Session

from .panel_desk import Bare, OpenBare
from .remote_desk import Harness as RemoteHarness
from .remote_desk import write_sketch
from .screen import Screen
from .session_desk import Harness, OpenSession


@pytest.fixture
def folder(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """Give a folder with the ``FILES`` of the test's file: texts by name."""
    for name, text in request.module.FILES.items():
        (tmp_path / name).write_text(text, encoding="utf-8")
    return tmp_path


@pytest.fixture
def bare(folder: Path, any_engine: Engine) -> Iterator[Bare]:
    """Give a panel on the sketch in the folder."""
    made = Bare(any_engine, folder)
    yield made
    made.close()


@pytest.fixture
def open_bare(any_engine: Engine) -> Iterator[OpenBare]:
    """Give what opens a panel on a sketch, until the test ends."""
    with ExitStack() as stack:
        yield lambda *words, **options: stack.enter_context(closing(Bare(any_engine, *words, **options)))


@pytest.fixture
def open_session(any_engine: Engine) -> Iterator[OpenSession]:
    """Give what opens a session on a sketch, until the test ends."""
    with ExitStack() as stack:

        def open_session(path: Path | str, **options: Any) -> Session:
            session = Session(any_engine, path, **options)
            stack.callback(session.release)
            return session

        yield open_session


@pytest.fixture
def harness(tmp_path: Path, any_engine: Engine) -> Iterator[Harness]:
    """Give a session whose sandbox answers when a test says so."""
    made = Harness(tmp_path, any_engine)
    yield made
    made.close()
    for session in made.sessions:
        session.release()


@pytest.fixture
def remote(tmp_path: Path, any_engine: Engine) -> Iterator[RemoteHarness]:
    """Give a session that draws frame after frame here, while a client runs in another thread."""
    made = RemoteHarness(any_engine, write_sketch(tmp_path / "hills"))
    yield made
    made.close()


@pytest.fixture(scope="module")
def screen(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    """Give a screen for the test's file, as large as its ``SCREEN`` says."""
    made = Screen(tmp_path_factory.mktemp("screen"), *request.module.SCREEN)
    yield made
    made.close()
