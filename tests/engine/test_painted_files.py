"""What the engine reads of a file to tell whether its textures are stale."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.data import content_hash as hashes
from playground.engine.painted_images import PaintedFiles


def test_huge_file_staleness_is_checked_without_reading(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    path = tmp_path / "a.r16"
    with path.open("wb") as handle:
        handle.truncate(2**27)  # sparse: it takes no room
    monkeypatch.setattr(hashes, "_hash", None)
    before = PaintedFiles().content(path)
    assert PaintedFiles().content(path) == before
    with path.open("ab") as handle:
        handle.write(b"more")
    assert PaintedFiles().content(path) != before
