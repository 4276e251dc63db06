"""Cache techniques from one load of a sketch to the next, for as long as their files stay the same.

A live session loads its sketch at every save, which changes one file of a hundred. A technique
is reused, as the same object, where every place that it was read from, and every place where
a file would take precedence over one of those, has the same signature.

Two saves can fall into one tick of a file system's clock and leave one signature. So a
technique is cached only if its files were unchanged for a while before: a later save then
has another time.
"""

from __future__ import annotations

import time
from collections import OrderedDict
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from playground.paths import GLSL
from playground.sketch.allowed_files import Signature, note_again, noting_part, signature
from playground.sketch.model import Technique
from playground.sketch.techniques import Techniques

RESTED = 3.0  # [s] from a file's last change to its reading, at least; FAT counts in steps of two seconds
_MOST = 256

_Name = tuple[str, Path, Path]


@dataclass(frozen=True, slots=True)
class _Entry:
    technique: Technique
    places: Mapping[Path, Signature | None]
    depth: int  # how deep techniques of several passes nest in it, itself among them

    def is_fresh(self) -> bool:
        """Return whether all files that it was read from are unchanged."""
        return all(signature(path) == known for path, known in self.places.items())


class TechniqueCache(Techniques):
    """Reads techniques for one sketch, load after load; ``begin`` comes before each."""

    def __init__(self) -> None:
        super().__init__()
        self._cached: OrderedDict[_Name, _Entry] = OrderedDict()
        self._now: dict[_Name, _Entry] = {}  # what this load has used

    def begin(self) -> TechniqueCache:
        """Begin a load: files may have changed since the last."""
        self._now = {}
        return self

    def read(self, use: str, folder: Path, root: Path) -> Technique:
        """Return what ``use`` names, as ``read_technique`` does."""
        name = (use, folder, root) if use.startswith("./") else (use, GLSL, GLSL)
        known = self._now.get(name)
        if known is None:
            known = self._cached.get(name)
            if known is not None and not known.is_fresh():
                known = None
        if known is None or not self.has_room_for(known.depth):
            known = self._read_again(name, use, folder, root)
        else:
            note_again(known.places)
            self.deepest = max(self.deepest, len(self.open) + known.depth)
        self._now[name] = known
        return known.technique

    def _read_again(self, name: _Name, use: str, folder: Path, root: Path) -> _Entry:
        around, self.deepest = self.deepest, len(self.open)
        began = time.time_ns()
        self.known.clear()  # it would not note where it read from
        try:
            with noting_part() as places:
                found = super().read(use, folder, root)
            read = _Entry(found, places, self.deepest - len(self.open))
        finally:
            self.deepest = max(around, self.deepest)
        latest = max((known[1] for known in places.values() if known is not None), default=0)
        self._cached.pop(name, None)
        if latest < began - RESTED * 1e9:
            self._cached[name] = read
            while len(self._cached) > _MOST:
                self._cached.popitem(last=False)
        return read
