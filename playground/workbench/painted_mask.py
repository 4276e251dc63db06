"""A mask that is painted on, and the image file that it is stored in.

The picture shows the mask from memory, stroke by stroke (see ``engine.painted_images``); the file is
written when a stroke has ended.
"""

from __future__ import annotations

import secrets
from collections import deque
from dataclasses import dataclass
from functools import reduce
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.images.files import new_name, read_image, write_png
from playground.sketch.allowed_files import Signature, signature
from playground.terrain.masks import resized, weights_of
from playground.workbench.brush import Brush, stroke

MOST_TEXELS = 4097
"""Of a mask's longer side; a larger terrain's is resampled from it."""
MOST_BY_FILE = 1024
"""Where the picture follows by the file only: a larger one takes longer to write than the mouse to move."""
_MOST_UNDONE = 24
_REMEMBERED = 256  # changes whose places are known

Part = tuple[slice, slice]
"""Rows and columns of a mask."""


@dataclass(frozen=True)
class _Patch:
    """A part of the mask as it was at another time."""

    part: Part
    pixels: NDArray[np.uint8]


class Canvas:
    """Four weights a texel, row 0 south."""

    def __init__(self, path: Path, mask: NDArray[np.float32]) -> None:
        self.path = path
        self.mask = mask
        self.pixels = _bytes(mask)  # what the file is to hold
        self.token = secrets.token_hex(8)
        self.version = 0
        self.saved = False  # whether the file holds what is painted
        self._written: Signature | None = None  # of the file, as it was written here
        self._changes: deque[tuple[int, Part]] = deque(maxlen=_REMEMBERED)  # each with its version
        self._start: NDArray[np.uint8] | None = None  # the pixels before the stroke that goes on
        self._touched: Part | None = None  # what it has painted on
        self._before: list[_Patch] = []  # what was there before each stroke, oldest first
        self._after: list[_Patch] = []  # after each that was taken back, the last one at the end

    @classmethod
    def begun(
        cls, folder: Path, name: str, of: Path | None, size: tuple[int, int], most: int = MOST_TEXELS
    ) -> Canvas:
        """Begin a file that is new in a folder: a copy of a mask, or nothing painted yet.

        ``size``: texels (nx, ny) of the pass that reads it, which it takes, up to ``most`` a side.
        Raises ``DataError`` where the mask cannot be read or the folder not be written to.
        """
        shrunk = min(1.0, most / max(size))
        nx, ny = (max(round(side * shrunk), 2) for side in size)
        mask = (
            np.zeros((ny, nx, 4), np.float32) if of is None else resized(weights_of(read_image(of)), (nx, ny))
        )
        with new_name(folder.resolve() / f"{name}.png") as path:
            made = cls(path, mask)
            made.save()
        return made

    @property
    def can_undo(self) -> bool:
        """Whether there is a stroke to take back."""
        return bool(self._before) or self._touched is not None

    @property
    def can_redo(self) -> bool:
        """Whether there is a stroke to paint again."""
        return bool(self._after)

    def holds(self) -> bool:
        """Say whether it is what its file holds, or newer; not where others have written the file."""
        return not self.saved or signature(self.path) == self._written

    def changed_since(self, version: int) -> Part:
        """Return the rows and columns of all that was changed since a version."""
        if version == self.version:
            return slice(0, 0), slice(0, 0)
        if self.version - version > len(self._changes):
            return self._whole()
        return reduce(_around, (part for at, part in self._changes if at > version))

    def begin(self) -> None:
        """Begin a stroke, which one undo will take back; what was taken back before is gone."""
        self._settle()
        self._start, self._after = self.pixels.copy(), []

    def paint(
        self, start: tuple[float, float], end: tuple[float, float], extent: tuple[float, float], brush: Brush
    ) -> None:
        """Go on with a stroke, from one place of the terrain to another, in shares of its sides."""
        part = stroke(self.mask, start, end, extent, brush)
        if self.mask[part].size:
            self.pixels[part] = _bytes(self.mask[part])
            self._change(part)

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
        self.mask[...] = 0.0
        self.pixels[...] = 0
        self._change(self._whole())
        self.save()

    def take_in(self) -> None:
        """Read the file, which others have written; strokes from before that cannot be taken back.

        Raises ``DataError`` where it cannot be read.
        """
        ny, nx = self.mask.shape[:2]
        self.mask = resized(weights_of(read_image(self.path)), (nx, ny))
        self.pixels = _bytes(self.mask)
        self._start = self._touched = None
        self._before, self._after = [], []
        self._change(self._whole())
        self.saved, self._written = True, signature(self.path)

    def save(self) -> None:
        """Write the file, whole or not at all. Raises ``DataError`` where that fails."""
        write_png(self.path, self.pixels[::-1])
        self.saved, self._written = True, signature(self.path)

    def _change(self, part: Part) -> None:
        """Take note that a part is another by now."""
        self.version += 1
        self._changes.append((self.version, part))
        if self._start is not None:
            self._touched = part if self._touched is None else _around(self._touched, part)
        self.saved = False

    def _settle(self) -> None:
        """End the stroke that goes on: what it has changed can be taken back."""
        if self._start is not None and self._touched is not None:
            patch = _Patch(self._touched, self._start[self._touched].copy())
            self._before = [*self._before, patch][-_MOST_UNDONE:]
        self._start = self._touched = None

    def _go(self, there: list[_Patch], back: list[_Patch]) -> None:
        """Put back the last part of a list, and what it replaces on the other."""
        if there:
            patch = there.pop()
            back.append(_Patch(patch.part, self.pixels[patch.part].copy()))
            self.pixels[patch.part] = patch.pixels
            self.mask[patch.part] = patch.pixels / np.float32(255)
            self._change(patch.part)
            self.save()

    def _whole(self) -> Part:
        ny, nx = self.mask.shape[:2]
        return slice(0, ny), slice(0, nx)


def _around(one: Part, other: Part) -> Part:
    """Return the rectangle around two."""
    rows, columns = (
        slice(min(a.start, b.start), max(a.stop, b.stop)) for a, b in zip(one, other, strict=True)
    )
    return rows, columns


def _bytes(mask: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.rint(np.clip(mask, 0.0, 1.0) * 255).astype(np.uint8)
