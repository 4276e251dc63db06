"""Where the values of a texture are that a lesson measures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Values = NDArray[np.float64]
"""(ny, nx), row 0 in the south."""


@dataclass(frozen=True, slots=True)
class Grid:
    """The places and metres of a heightmap's texels."""

    spacing: tuple[float, float] = (1.0, 1.0)  # [m] from texel to texel, eastwards and northwards
    relief: float = 1.0  # [m] from height 0 to height 1
