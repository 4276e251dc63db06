"""Keep techniques from one reading of a sketch to the next, for as long as their files are as they were.

A live session reads its sketch anew at every save, which changes one file of a hundred. A
technique is taken again, as the same object, where every place that it was read from, and
every place where something might have stood before it, shows the same signature.

Two saves can fall into one tick of a file system's clock and leave one signature. So only
what had rested for a while when it was read is kept: a later save shows another time.
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

RESTED = 3.0  # [s] between a file's last change and its reading; FAT counts in steps of two seconds
_MOST = 256

_Name = tuple[str, Path, Path]


@dataclass(frozen=True, slots=True)
class _Kept:
    technique: Technique
    places: Mapping[Path, Signature | None]
    depth: int  # how deep techniques of several passes nest in it, itself among them

    def stands(self) -> bool:
        """Return whether all that it was read from is as it was."""
        return all(signature(path) == seen for path, seen in self.places.items())


class KeptTechniques(Techniques):
    """Reads techniques for one sketch, again and again; ``begin`` comes before each reading."""

    def __init__(self) -> None:
        super().__init__()
        self._kept: OrderedDict[_Name, _Kept] = OrderedDict()
        self._now: dict[_Name, _Kept] = {}  # what this reading has met

    def begin(self) -> KeptTechniques:
        """Begin a reading: files may have changed since the last."""
        self._now = {}
        return self

    def read(self, use: str, folder: Path, root: Path) -> Technique:
        """Return what ``use`` names, as ``read_technique`` does."""
        name = (use, folder, root) if use.startswith("./") else (use, GLSL, GLSL)
        known = self._now.get(name)
        if known is None:
            known = self._kept.get(name)
            if known is not None and not known.stands():
                known = None
        if known is None or not self.has_room_for(known.depth):
            known = self._anew(name, use, folder, root)
        else:
            note_again(known.places)
            self.deepest = max(self.deepest, len(self.open) + known.depth)
        self._now[name] = known
        return known.technique

    def _anew(self, name: _Name, use: str, folder: Path, root: Path) -> _Kept:
        around, self.deepest = self.deepest, len(self.open)
        began = time.time_ns()
        self.known.clear()  # it would keep silent about where it read from
        try:
            with noting_part() as places:
                found = super().read(use, folder, root)
            read = _Kept(found, places, self.deepest - len(self.open))
        finally:
            self.deepest = max(around, self.deepest)
        latest = max((seen[1] for seen in places.values() if seen is not None), default=0)
        self._kept.pop(name, None)
        if latest < began - RESTED * 1e9:
            self._kept[name] = read
            while len(self._kept) > _MOST:
                self._kept.popitem(last=False)
        return read
