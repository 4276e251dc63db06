"""A mask that is painted on, and the image file that it is kept in."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.images.files import new_name, read_image, write_png
from playground.live.brush import Brush, stroke
from playground.terrain.resample import resample

LONGER_SIDE = 512
"""Texels of a new mask's longer side."""
_MOST_UNDONE = 24


class Canvas:
    """Four weights a texel, row 0 south; saved after each stroke and each undo."""

    def __init__(self, path: Path, mask: NDArray[np.float32]) -> None:
        self.path = path
        self.mask = mask
        self._before: list[NDArray[np.uint8]] = []  # the mask before each stroke, oldest first

    @classmethod
    def begun(cls, folder: Path, name: str, of: Path | None, extent: tuple[float, float]) -> Canvas:
        """Begin a file that is new in a folder: a copy of a mask, or nothing painted yet.

        A mask coarser than ``LONGER_SIDE`` becomes as fine as that, with the land's proportions.

        Raises ``DataError`` where the mask cannot be read or the folder not be written to.
        """
        mask = _empty(extent)
        if of is not None:
            given = _read(of)
            mask = given if max(given.shape) >= LONGER_SIDE else _finer(given, mask.shape)
        with new_name(folder / f"{name}.png") as path:
            made = cls(path, mask)
            made.save()
        return made

    @property
    def can_undo(self) -> bool:
        """Whether there is a stroke to take back."""
        return bool(self._before)

    def begin(self) -> None:
        """Begin a stroke, which one undo will take back."""
        self._before = [*self._before, _bytes(self.mask)][-_MOST_UNDONE:]

    def paint(
        self, start: tuple[float, float], end: tuple[float, float], extent: tuple[float, float], brush: Brush
    ) -> None:
        """Go on with a stroke, from one place of the land to another, in shares of its sides."""
        stroke(self.mask, start, end, extent, brush)

    def undo(self) -> None:
        """Take the last stroke back."""
        if self._before:
            self.mask = (self._before.pop() / np.float32(255)).astype(np.float32)
            self.save()

    def clear(self) -> None:
        """Take all paint away; that can be undone as well."""
        self.begin()
        self.mask[...] = 0.0
        self.save()

    def save(self) -> None:
        """Write the file, whole or not at all. Raises ``DataError`` where that fails."""
        write_png(self.path, _bytes(self.mask)[::-1])


def _bytes(mask: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.rint(np.clip(mask, 0.0, 1.0) * 255).astype(np.uint8)


def _read(path: Path) -> NDArray[np.float32]:
    image = read_image(path)
    pixels = image.pixels[::-1]
    mask = pixels / np.float32(255) if pixels.dtype == np.uint8 else pixels.astype(np.float32)
    mask = np.array(mask, np.float32)
    if not image.transparent:
        mask[..., 3] = 0.0
    return mask


def _finer(mask: NDArray[np.float32], shape: tuple[int, ...]) -> NDArray[np.float32]:
    channels = [resample(mask[..., k], (shape[1], shape[0]), within=(0.0, 1.0)) for k in range(4)]
    return np.stack(channels, axis=-1).astype(np.float32)


def _empty(extent: tuple[float, float]) -> NDArray[np.float32]:
    scale = LONGER_SIDE / max(extent)
    width, height = (max(round(side * scale), 2) for side in extent)
    return np.zeros((height, width, 4), np.float32)
