"""Numbers that are painted: metres that are added to terrain, or factors; in a TIFF of 32-bit floats."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from playground.data.resample import resample
from playground.engine.file_sources import read_numbers, write_numbers
from playground.workbench.brush import Brush, reached
from playground.workbench.canvas import Canvas
from playground.workbench.erode_tool import ErodeTool
from playground.workbench.sculpting import sculpt

RISE = 0.5  # [1/s] radii that raise goes at full strength, where metres are painted
FACTOR = 1.0  # [1/s] how fast it goes where other numbers are


def rate_of(brush: Brush, *, metres: bool) -> float:
    """Return how fast raise goes at full strength: metres a second, or numbers."""
    return RISE * brush.radius if metres else FACTOR


class Sculpture(Canvas):
    """A number a texel, and the ground that it is added to."""

    ending = ".tif"
    channels = ()
    dtype = np.float32

    def __init__(self, path: Path, pixels: NDArray[np.float32]) -> None:
        super().__init__(path, pixels)
        self.level: float | None = None  # what the stroke that goes on flattens to
        self.ground: NDArray[np.float32] | None = None  # (ny, nx) [m] that it is added to; None: to none
        self.eroding: ErodeTool | None = None  # what "erode" runs; None: nothing

    def set_base(self, heights: NDArray[np.float32] | None) -> None:
        """Take the heights [m] that it is added to, at any size; None where it changes no height."""
        if heights is not None and heights.shape != self.pixels.shape:
            heights = resample(heights, self.size)
        self.ground = heights

    @staticmethod
    def read(path: Path, size: tuple[int, int]) -> NDArray[np.float32]:
        """Return a file's numbers at a size (nx, ny). Raises ``DataError`` where it cannot be read."""
        return np.array(read_numbers(path, size))

    @classmethod
    def write(cls, path: Path, pixels: NDArray[np.float32]) -> None:
        """Write numbers to a file, whole or not at all. Raises ``DataError`` where that fails."""
        write_numbers(path, pixels)

    def begin(self) -> None:
        """Begin a stroke, which one undo will take back; it flattens to the height where it begins."""
        super().begin()
        self.level = None

    def paint(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        extent: tuple[float, float],
        brush: Brush,
        seconds: float = 0.0,
    ) -> None:
        """Go on with a stroke for some seconds. Raises ``PlaygroundError`` where a technique fails."""
        if self.level is None:
            self.level = self._height_at(start) if brush.level is None else brush.level
            if self.eroding is not None:
                self.eroding.begin(self._height_at(start))
        if brush.tool == "erode":
            self._erode(start, end, extent, brush, seconds)
            return
        part = reached(self.size, start, end, extent, brush.radius)
        if not self.pixels[part].size:
            return
        self._remember(part)
        sculpt(
            self.pixels,
            self.ground,
            (start, end),
            extent,
            brush,
            seconds=seconds,
            rate=rate_of(brush, metres=self.ground is not None),
            level=self.level,
        )
        self._change(part)

    def _erode(
        self,
        start: tuple[float, float],
        end: tuple[float, float],
        extent: tuple[float, float],
        brush: Brush,
        seconds: float,
    ) -> None:
        if self.eroding is None:
            return
        for position in self.eroding.stamps(start, end, seconds):
            terrain = self.pixels, self.ground
            part, added = self.eroding.change(terrain, position, extent, brush)
            self._remember(part)
            self.pixels[part] += added
            self._change(part)

    def _height_at(self, position: tuple[float, float]) -> float:
        """Return the terrain's height at its texel nearest to a place."""
        x, y = (
            round(min(max(share, 0.0), 1.0) * (n - 1)) for share, n in zip(position, self.size, strict=True)
        )
        return float(self.pixels[y, x]) + (0.0 if self.ground is None else float(self.ground[y, x]))
