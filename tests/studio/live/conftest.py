"""What tests of the live window share: a sketch's folder, a panel on it without a screen, a screen."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.engine.engine import Engine

from .desk import Bare
from .screen import Screen


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


@pytest.fixture(scope="module")
def screen(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Screen]:
    """Give a screen for the test's file, as large as its ``SCREEN`` says."""
    made = Screen(tmp_path_factory.mktemp("screen"), *request.module.SCREEN)
    yield made
    made.close()
