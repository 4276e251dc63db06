"""Which images and elevation files have been drawn with: new contents go through the sandbox first.

What a new file does to its reader is not known yet; a process of its own finds out.
"""

from __future__ import annotations

from pathlib import Path

from playground.data.content_hash import content_hash
from playground.errors import PlaygroundError
from playground.sketch.model import Sketch
from playground.studio.reload.dependencies import data_files


class DataFiles:
    """The files that one session has drawn with."""

    def __init__(self) -> None:
        self._known: dict[Path, str] = {}  # a hash of the contents
        self._own: set[Path] = set()  # written by this process

    def trust(self, path: Path) -> None:
        """Take a file that this process writes for good: it needs no sandbox."""
        self._own.add(path)

    def are_new(self, sketch: Sketch) -> bool:
        """Say whether a sketch reads data that was never drawn with; a newer date alone is no new data."""
        return any(
            path not in self._own and self._known.get(path) != hash_of(path) for path in data_files(sketch)
        )

    def take(self, sketch: Sketch) -> None:
        """Remember the data that a sketch was drawn with."""
        self._known.update((path, hash_of(path)) for path in data_files(sketch))


def hash_of(path: Path) -> str:
    """Return a hash of a file's contents; empty where it cannot be read."""
    try:
        return content_hash(path)
    except (PlaygroundError, OSError):
        return ""
