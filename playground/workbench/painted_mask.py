"""A mask that is painted on: four weights a texel, in a PNG of 8 bits a channel."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.data.image_files import read_image, write_png
from playground.engine.file_sources import resized, weights_of
from playground.workbench.brush import Brush, reached, stroke
from playground.workbench.canvas import Canvas, Patch

MAX_SIDE_BY_FILE = 1024
"""Where the picture follows by the file only: a larger one takes longer to write than the mouse to move."""


class Mask(Canvas):
    """Four weights a texel, 0..1."""

    ending = ".png"
    channels = (4,)
    dtype = np.uint8

    def __init__(self, path: Path, pixels: NDArray[np.uint8]) -> None:
        super().__init__(path, pixels)
        # In steps finer than the file's, which soft strokes add up.
        self.mask = np.asarray(pixels / np.float32(255), np.float32)

    @staticmethod
    def read(path: Path, size: tuple[int, int]) -> NDArray[np.uint8]:
        """Return an image's channels at a size (nx, ny). Raises ``DataError`` where it cannot be read."""
        return _bytes(resized(weights_of(read_image(path)), size))

    @classmethod
    def write(cls, path: Path, pixels: NDArray[np.uint8]) -> None:
        """Write channels to a file, whole or not at all. Raises ``DataError`` where that fails."""
        write_png(path, pixels[::-1])

    def paint(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        extent: tuple[float, float],
        brush: Brush,
        seconds: float = 0.0,
    ) -> None:
        """Go on with a stroke; what it covers does not depend on how long it takes."""
        part = reached(self.size, start, end, extent, brush.radius)
        self._remember(part)
        stroke(self.mask, start, end, extent, brush)
        if self.mask[part].size:
            self.pixels[part] = _bytes(self.mask[part])
            self._change(part)

    def _replace(self, patch: Patch) -> None:
        super()._replace(patch)
        self.mask[patch.part] = patch.pixels / np.float32(255)


def _bytes(mask: NDArray[np.float32]) -> NDArray[np.uint8]:
    return np.rint(np.clip(mask, 0.0, 1.0) * 255).astype(np.uint8)
