"""What tests of the window share: a sketch's folder, a panel or a session on it, a remote, a screen."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.engine.engine import Engine

from .panel_desk import Bare
from .remote_desk import Harness as RemoteHarness
from .remote_desk import write_sketch
from .screen import Screen
from .session_desk import Harness


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
