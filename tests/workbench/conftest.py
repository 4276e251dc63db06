"""A session whose sandbox answers when a test says so."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.engine.engine import Engine

from .checked_desk import Desk


@pytest.fixture
def desk(tmp_path: Path, any_engine: Engine) -> Iterator[Desk]:
    made = Desk(tmp_path, any_engine)
    yield made
    made.close()
    for session in made.sessions:
        session.release()
