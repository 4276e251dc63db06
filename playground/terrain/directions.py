"""Turn directions on the terrain, azimuth and elevation, into vectors."""

from __future__ import annotations

import math
from collections.abc import Sequence


def unit_vector(direction: Sequence[float]) -> tuple[float, float, float]:
    """Return the unit vector (east, north, up) of an azimuth and an elevation [degrees].

    Azimuths are clockwise from north, elevations above the horizon; exact at quarter turns,
    as ``glsl/lighting/sun.glsl`` is.
    """
    azimuth, elevation = direction
    north, east = _cos_sin(azimuth)
    level, up = _cos_sin(elevation)
    return east * level, north * level, up


def _cos_sin(degrees: float) -> tuple[float, float]:
    turns = math.floor(degrees / 90.0 + 0.5)
    rest = math.radians(degrees - 90.0 * turns)
    c, s = math.cos(rest), math.sin(rest)
    return ((c, s), (-s, c), (-c, -s), (s, -c))[turns % 4]
