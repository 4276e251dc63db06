"""Turn directions on the terrain, azimuth and elevation, into vectors.

Sums and products alone, in a fixed order: no two libraries of mathematics agree on the last bit of
a sine, and a web page must see what the engine sees (directions.js, tested for equality).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

# Taylor's, up to the term below which nothing is left of 45 degrees in double precision.
_SINE = [(-1) ** n / math.factorial(2 * n + 1) for n in range(9)]
_COSINE = [(-1) ** n / math.factorial(2 * n) for n in range(10)]


def unit_vector(direction: Sequence[float]) -> tuple[float, float, float]:
    """Return the unit vector (east, north, up) of an azimuth and an elevation [degrees].

    Azimuths are clockwise from north, elevations above the horizon; exact at quarter turns,
    as ``glsl/lighting/sun.glsl`` is.
    """
    azimuth, elevation = direction
    north, east = cos_sin(azimuth)
    level, up = cos_sin(elevation)
    return east * level, north * level, up


def cos_sin(degrees: float) -> tuple[float, float]:
    """Return an angle's cosine and sine: exact at quarter turns, else to two units of the last bit."""
    degrees = math.fmod(degrees, 360.0)
    quarters = math.floor(degrees / 90.0 + 0.5)
    x = (degrees - 90.0 * quarters) * (math.pi / 180.0)
    c, s = _series(_COSINE, x * x), x * _series(_SINE, x * x)
    return ((c, s), (-s, c), (-c, -s), (s, -c))[quarters % 4]


def _series(factors: Sequence[float], x: float) -> float:
    found = 0.0
    for factor in reversed(factors):
        found = found * x + factor
    return found
