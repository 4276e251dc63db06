"""What the tests of other tools' shaders share: an empty folder for a text."""

from __future__ import annotations

from pathlib import Path

import pytest

from ..engine.conftest import Folder


@pytest.fixture
def folder(tmp_path: Path) -> Folder:
    """Give an empty folder for a text and what it reads."""
    path = tmp_path / "mine"
    path.mkdir()
    return Folder(path)
