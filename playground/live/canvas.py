"""A mask that is painted on, and the image file that it is kept in."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.images.files import new_name, read_image, write_png
from playground.live.brush import Brush, stroke
from playground.terrain.masks import resized, weights_of

MOST_TEXELS = 1024
"""Of a mask's longer side: a larger file would take longer to write than a hand takes to move."""
_MOST_UNDONE = 24


class Canvas:
    """Four weights a texel, row 0 south."""

    def __init__(self, path: Path, mask: NDArray[np.float32]) -> None:
        self.path = path
        self.mask = mask
        self.saved = False  # whether the file holds what is painted
        self._before: list[NDArray[np.uint8]] = []  # the mask before each stroke, oldest first
        self._after: list[NDArray[np.uint8]] = []  # after each that was taken back, the last one at the end

    @classmethod
    def begun(cls, folder: Path, name: str, of: Path | None, size: tuple[int, int]) -> Canvas:
        """Begin a file that is new in a folder: a copy of a mask, or nothing painted yet.

        ``size``: texels (nx, ny) of the pass that reads it, whose proportions it takes.
        Raises ``DataError`` where the mask cannot be read or the folder not be written to.
        """
        shrunk = min(1.0, MOST_TEXELS / max(size))
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
        return bool(self._before)

    @property
    def can_redo(self) -> bool:
        """Whether there is a stroke to paint again."""
        return bool(self._after)

    def begin(self) -> None:
        """Begin a stroke, which one undo will take back; what was taken back before is gone."""
        self._before = [*self._before, _bytes(self.mask)][-_MOST_UNDONE:]
        self._after = []

    def paint(
        self, start: tuple[float, float], end: tuple[float, float], extent: tuple[float, float], brush: Brush
    ) -> None:
        """Go on with a stroke, from one place of the land to another, in shares of its sides."""
        stroke(self.mask, start, end, extent, brush)
        self.saved = False

    def undo(self) -> None:
        """Take the last stroke back, and save."""
        self._go(self._before, self._after)

    def redo(self) -> None:
        """Paint the stroke again that was taken back last, and save."""
        self._go(self._after, self._before)

    def clear(self) -> None:
        """Take all paint away, and save; that can be undone as well."""
        self.begin()
        self.mask[...] = 0.0
        self.save()

    def _go(self, there: list[NDArray[np.uint8]], back: list[NDArray[np.uint8]]) -> None:
        """Take the last mask of a list, and put the one of now on the other."""
        if there:
            back.append(_bytes(self.mask))
            self.mask = (there.pop() / np.float32(255)).astype(np.float32)
            self.save()

    def save(self) -> None:
        """Write the file, whole or not at all. Raises ``DataError`` where that fails."""
        write_png(self.path, _bytes(self.mask)[::-1])
        self.saved = True


def _bytes(mask: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.rint(np.clip(mask, 0.0, 1.0) * 255).astype(np.uint8)
