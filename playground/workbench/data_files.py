"""Which images and elevation files have been drawn with: new contents go through the sandbox first.

What a new file does to its reader is not known yet; a process of its own finds out.
"""

from __future__ import annotations

from pathlib import Path

from playground.errors import PlaygroundError
from playground.images.content_hash import content_hash
from playground.sketch.allowed_files import Signature, signature
from playground.sketch.model import Sketch
from playground.workbench.dependencies import data_files


class DataFiles:
    """The files that one session has drawn with."""

    def __init__(self) -> None:
        self._known: dict[Path, tuple[Signature | None, str]] = {}  # as they were, and a hash of the contents
        self._own: set[Path] = set()  # written by this process

    def trust(self, path: Path) -> None:
        """Take a file that this process writes for good: it needs no sandbox."""
        self._own.add(path)

    def are_new(self, sketch: Sketch) -> bool:
        """Say whether a sketch reads data that was never drawn with; a newer date alone is no new data."""
        return any(path not in self._own and self._is_new(path) for path in data_files(sketch))

    def take(self, sketch: Sketch) -> None:
        """Remember the data that a sketch was drawn with."""
        for path in data_files(sketch):
            now = signature(path)
            if now is None or self._known.get(path, (None, ""))[0] != now:
                self._known[path] = now, hash_of(path)

    def _is_new(self, path: Path) -> bool:
        known, now = self._known.get(path), signature(path)
        if known is None or now is None or known[0] is None:
            return known is None or known[0] != now
        if known[0] != now:
            if hash_of(path) != known[1]:
                return True
            self._known[path] = now, known[1]
        return False


def hash_of(path: Path) -> str:
    """Return a hash of a file's contents; empty where it cannot be read."""
    try:
        return content_hash(path)
    except (PlaygroundError, OSError):
        return ""
