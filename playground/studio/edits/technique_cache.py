"""Cache techniques from one load of a sketch to the next, for as long as their files stay the same.

A live session loads its sketch at every save, which changes one file of a hundred. A technique
is reused, as the same object, where every text that it was read from is the same, and every
other place where a file was looked for has the same signature. A text is read again unless its
file's signature proves that it is the same: a save may keep inode, size and time of modification,
two saves may fall into one tick of a clock, and Windows has no time that no program sets. A text that
is taken in place of a file's (``reading_unsaved``) is compared each time.
"""

from __future__ import annotations

import os
import time
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

from playground.allowed_files import (
    Signature,
    note_again,
    noting_part,
    signature_in_load,
    texts_of_load,
    unsaved_texts,
)
from playground.errors import PlaygroundError
from playground.memo import Memo
from playground.paths import GLSL
from playground.shader.source import read_text
from playground.sketch.model import Technique
from playground.sketch.techniques import Techniques

RESTED = 3.0  # [s] from a file's last change to its reading, at least; FAT counts in steps of two seconds
_MAX_TECHNIQUES = 256

_Name = tuple[str, Path, Path]


@dataclass(frozen=True, slots=True)
class _Entry:
    technique: Technique
    places: Mapping[Path, Signature | None]  # where files were looked for
    texts: Mapping[tuple[Path, bool], str]  # those that were read, by path and whether in any encoding
    unproven: frozenset[Path]  # whose signature does not prove that a text is the same
    depth: int  # how deep techniques of several passes nest in it, itself among them

    def is_fresh(self) -> bool:
        """Return whether all files that it was read from are unchanged."""
        unproven = self.unproven | unsaved_texts().keys()
        return all(
            (signature_in_load(path) == signature and path not in unproven) or self._has_same_text(path)
            for path, signature in self.places.items()
        )

    def _has_same_text(self, path: Path) -> bool:
        """Return whether a file that was read has the same text."""
        read = [(any_encoding, self.texts.get((path, any_encoding))) for any_encoding in (False, True)]
        try:
            same = [read_text(path, any_encoding=flag) == text for flag, text in read if text is not None]
        except PlaygroundError:  # it cannot be read any more
            return False
        return bool(same) and all(same)


class TechniqueCache(Techniques):
    """Reads techniques for one sketch, load after load; ``begin`` comes before each."""

    def __init__(self) -> None:
        super().__init__()
        self._cached: Memo[_Name, _Entry] = Memo("techniques", _MAX_TECHNIQUES)
        self._now: dict[_Name, _Entry] = {}  # what this load has used

    def begin(self) -> TechniqueCache:
        """Begin a load: files may have changed since the last."""
        self._now = {}
        return self

    def read(self, use: str, folder: Path, root: Path) -> Technique:
        """Return what ``use`` names, as ``read_technique`` does."""
        name = (use, folder, root) if use.startswith("./") else (use, GLSL, GLSL)
        cached = self._now.get(name) or self._cached.get(name)
        if cached is not None and name not in self._now and not cached.is_fresh():
            cached = None
        if cached is None or not self.has_room_for(cached.depth):
            cached = self._read_again(name, use, folder, root)
        else:
            note_again(cached.places)
            self.deepest = max(self.deepest, len(self.open) + cached.depth)
        self._now[name] = cached
        return cached.technique

    def _read_again(self, name: _Name, use: str, folder: Path, root: Path) -> _Entry:
        around, self.deepest = self.deepest, len(self.open)
        began = time.time_ns()
        self.techniques.clear()  # it would not note where it read from
        try:
            with noting_part() as places:
                technique = super().read(use, folder, root)
        finally:
            self.deepest, depth = max(around, self.deepest), self.deepest - len(self.open)
        unsaved = unsaved_texts()
        in_load = (texts_of_load() or {}) | {(path, False): text for path, text in unsaved.items()}
        keys = [(path, any_encoding) for path in places for any_encoding in (False, True)]
        texts = {key: in_load[key] for key in keys if key in in_load}
        rested = 0 if os.name == "nt" else began - RESTED * 1e9
        unproven = frozenset(
            path
            for path, _ in texts
            if path in unsaved or (signature := places[path]) is None or signature.latest >= rested
        )
        return self._cached.put(name, _Entry(technique, places, texts, unproven, depth))
