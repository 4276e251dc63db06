"""An image that is painted on, and the file that it is stored in.

The picture shows the image from memory, stroke by stroke (see ``engine.painted_images``); the file is
written when a stroke has ended, on a thread, of a copy (see ``latest_write``). What a stroke changes is
remembered by tiles: a copy of each tile from before the stroke, made where the brush reaches it first, so
that the cost of a stroke follows the brush and not the image.
"""

from __future__ import annotations

import secrets
from abc import ABC, abstractmethod
from collections import deque
from dataclasses import dataclass
from functools import reduce
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from playground.files import new_name
from playground.workbench.brush import Brush, Part
from playground.workbench.data_files import hash_of
from playground.workbench.latest_write import LatestWrite

MAX_TEXELS = 4097
"""Of an image's longer side; a larger terrain's is resampled from it."""
_TILE = 64  # texels of a side
_MAX_UNDO_STEPS = 24
_REMEMBERED = 256  # changes whose places are known


@dataclass(frozen=True)
class Patch:
    """A part of the image as it was at another time."""

    part: Part
    pixels: NDArray[Any]


_Stroke = list[Patch]


class Canvas(ABC):
    """An image of (ny, nx) texels or (ny, nx, channels), row 0 south, and its file, north row first."""

    ending: ClassVar[str]  # of the file's name
    channels: ClassVar[tuple[int, ...]]  # () for one number a texel
    dtype: ClassVar[type[np.generic]]

    def __init__(self, path: Path, pixels: NDArray[Any]) -> None:
        self.path = path
        self.pixels = pixels  # what the file is to hold
        self.token = secrets.token_hex(8)
        self.version = 0
        self.writing = LatestWrite()
        self._given = -1  # the version that was given to be written last
        self._written = ""  # a hash of the file, as it was written here
        self._changes: deque[tuple[int, Part]] = deque(maxlen=_REMEMBERED)  # each with its version
        self._tiles: dict[tuple[int, int], Patch] | None = None  # from before the stroke that goes on
        self._before: list[_Stroke] = []  # what was there before each stroke, oldest first
        self._after: list[_Stroke] = []  # after each that was undone, the last one at the end

    @classmethod
    def create(
        cls, folder: Path, name: str, of: Path | None, size: tuple[int, int], most: int = MAX_TEXELS
    ) -> Self:
        """Begin a file that is new in a folder: a copy of another one, or nothing painted yet.

        ``size``: texels (nx, ny) of the pass that reads it, which it takes, up to ``most`` a side.
        Raises ``DataError`` where the file cannot be read or the folder not be written to.
        """
        shrunk = min(1.0, most / max(size))
        nx, ny = (max(round(side * shrunk), 2) for side in size)
        pixels = cls.read(of, (nx, ny)) if of else np.zeros((ny, nx, *cls.channels), cls.dtype)
        with new_name(folder.resolve() / f"{name}{cls.ending}") as path:
            made = cls(path, pixels)
            made.save()
            made.writing.wait()
        return made

    @staticmethod
    @abstractmethod
    def read(path: Path, size: tuple[int, int]) -> NDArray[Any]:
        """Return a file's pixels at a size (nx, ny). Raises ``DataError`` where it cannot be read."""

    @classmethod
    @abstractmethod
    def write(cls, path: Path, pixels: NDArray[Any]) -> None:
        """Write pixels to a file, whole or not at all. Raises ``DataError`` where that fails."""

    @abstractmethod
    def paint(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        extent: tuple[float, float],
        brush: Brush,
        seconds: float = 0.0,
    ) -> None:
        """Go on with a stroke for some seconds, from one place to another, as ``reached`` takes them."""

    @property
    def size(self) -> tuple[int, int]:
        """Texels (nx, ny)."""
        ny, nx = self.pixels.shape[:2]
        return nx, ny

    @property
    def saved(self) -> bool:
        """Whether the file holds what is painted, or is about to; not where writing it has failed."""
        return self._given == self.version and (self.writing.pending or self.writing.error is None)

    @property
    def can_undo(self) -> bool:
        """Whether there is a stroke to undo."""
        return bool(self._before or self._tiles)

    @property
    def can_redo(self) -> bool:
        """Whether there is a stroke to paint again."""
        return bool(self._after)

    def holds(self) -> bool:
        """Return whether it is what its file holds, or newer; not where others have written the file."""
        return self.writing.pending or not self.saved or hash_of(self.path) == self._written

    def changed_since(self, version: int) -> Part:
        """Return the rows and columns of all that was changed since a version."""
        if version == self.version:
            return slice(0, 0), slice(0, 0)
        if self.version - version > len(self._changes):
            return self._whole()
        return reduce(_around, (part for at, part in self._changes if at > version))

    def begin(self) -> None:
        """Begin a stroke, which one undo will take back; what was undone before is gone."""
        self._settle()
        self._tiles, self._after = {}, []

    def undo(self) -> None:
        """Undo the last stroke, and save."""
        self._settle()
        self._go(self._before, self._after)

    def redo(self) -> None:
        """Redo the stroke that was undone last, and save."""
        self._go(self._after, self._before)

    def clear(self) -> None:
        """Take all paint away, and save; that can be undone as well."""
        self.begin()
        whole = self._whole()
        self._remember(whole)
        self._replace(Patch(whole, np.zeros_like(self.pixels)))
        self._change(whole)
        self.save()

    def take_in(self) -> None:
        """Read the file, which others have written; strokes from before that cannot be undone.

        Raises ``DataError`` where it cannot be read.
        """
        whole = self._whole()
        self._replace(Patch(whole, self.read(self.path, self.size)))
        self._tiles = None
        self._before, self._after = [], []
        self._change(whole)
        self._given, self._written = self.version, hash_of(self.path)

    def save(self) -> None:
        """Have the file written soon, as the image is now; ``writing`` has what goes wrong."""
        pixels, self._given = self.pixels.copy(), self.version

        def write() -> None:
            self.write(self.path, pixels)
            self._written = hash_of(self.path)

        self.writing.give(write)

    def _replace(self, patch: Patch) -> None:
        """Put pixels in their place."""
        self.pixels[patch.part] = patch.pixels

    def _remember(self, part: Part) -> None:
        """Copy the tiles of a part that the stroke is about to reach for the first time."""
        if self._tiles is None or not self.pixels[part].size:
            return
        rows, columns = (range(side.start // _TILE, -(-side.stop // _TILE)) for side in part)
        for row in rows:
            for column in columns:
                if (row, column) not in self._tiles:
                    tile = _tile(row), _tile(column)
                    self._tiles[row, column] = Patch(tile, self.pixels[tile].copy())

    def _change(self, part: Part) -> None:
        """Note that a part has changed."""
        self.version += 1
        self._changes.append((self.version, part))

    def _settle(self) -> None:
        """End the stroke that goes on: what it has changed can be undone."""
        if self._tiles:
            self._before = [*self._before, list(self._tiles.values())][-_MAX_UNDO_STEPS:]
        self._tiles = None

    def _go(self, there: list[_Stroke], back: list[_Stroke]) -> None:
        """Put back the last stroke of a list, and what it replaces on the other."""
        if not there:
            return
        patches = there.pop()
        back.append([Patch(patch.part, self.pixels[patch.part].copy()) for patch in patches])
        for patch in patches:
            self._replace(patch)
        self._change(reduce(_around, (patch.part for patch in patches)))
        self.save()

    def _whole(self) -> Part:
        nx, ny = self.size
        return slice(0, ny), slice(0, nx)


def _tile(number: int) -> slice:
    return slice(number * _TILE, (number + 1) * _TILE)


def _around(first: Part, other: Part) -> Part:
    """Return the rectangle around two."""
    rows, columns = (
        slice(min(a.start, b.start), max(a.stop, b.stop)) for a, b in zip(first, other, strict=True)
    )
    return rows, columns
