"""A session that draws frame after frame here, while a client runs in another thread."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from playground.engine.engine import Engine

from .desk import Harness, write_sketch


@pytest.fixture
def harness(tmp_path: Path, any_engine: Engine) -> Iterator[Harness]:
    made = Harness(any_engine, write_sketch(tmp_path / "hills"))
    yield made
    made.close()
