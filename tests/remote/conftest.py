"""A session that draws frame after frame here, while a client runs in another thread."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.engine.engine import Engine

from .desk import Desk, write_sketch


@pytest.fixture
def desk(tmp_path: Path, any_engine: Engine) -> Iterator[Desk]:
    made = Desk(any_engine, write_sketch(tmp_path / "hills"))
    yield made
    made.close()
