"""What is known of a terrain."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from playground.terrain.place import Place


@dataclass(frozen=True, slots=True)
class Terrain:
    """What a source knows of its terrain; None where it does not."""

    size: tuple[int, int] | None = None  # texels, x and y
    extent: tuple[float, float] | None = None  # [m]
    relief: float | None = None  # [m] from height 0 to height 1
    base_elevation: float | None = None  # [m] above sea level at height 0
    place: Place | None = None  # where it lies on the Earth
    assumed: str = ""  # of the unit of its heights, where nothing says it

    def metres(self, heights: NDArray[np.float32]) -> NDArray[np.float32]:
        """Return heights 0..1 in metres above sea level, float32; the relief and the base must be known."""
        assert self.relief is not None and self.base_elevation is not None
        return (heights.astype(np.float64) * self.relief + self.base_elevation).astype(np.float32)
