"""Read what a flight needs of a daylight's texture: sun, sky and date (lighting/daylight_reading)."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Three = tuple[float, float, float]


class Daylight(NamedTuple):
    """Sun and sky at one time of day."""

    to_sun: Three = (0.0, 0.0, 1.0)
    sun: Three = (0.0, 0.0, 0.0)  # its light on what faces it; none where it is below the horizon
    sky: Three = (0.0, 0.0, 0.0)  # the sky's on open level ground
    day: float = 0.0  # of the year, from the first of January


def daylight_of(texels: NDArray[np.float32]) -> Daylight:
    """Return what the texels of a daylight say (rows, columns, 4); few have but the sun's place."""
    row = texels[0, :, :].astype(float)
    to_sun = _three(row[0])
    if len(row) < 6:
        return Daylight(to_sun)
    sun = _three(row[1]) if to_sun[2] > 0 else (0.0, 0.0, 0.0)
    return Daylight(to_sun, sun, _three(row[2]), float(row[5, 3]))


def _three(texel: NDArray[np.float64]) -> Three:
    return float(texel[0]), float(texel[1]), float(texel[2])
