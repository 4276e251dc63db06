"""A session whose sandbox answers when a test says so."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.engine.engine import Engine

from .checked_desk import Harness


@pytest.fixture
def harness(tmp_path: Path, any_engine: Engine) -> Iterator[Harness]:
    made = Harness(tmp_path, any_engine)
    yield made
    made.close()
    for session in made.sessions:
        session.release()
