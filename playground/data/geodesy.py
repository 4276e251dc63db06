"""Convert degrees to metres, so that terrain given in degrees has metres.

It does not reproject. Source: Snyder 1987, "Map Projections: A Working Manual", USGS
Professional Paper 1395.
"""

from __future__ import annotations

import math


def degree_lengths(latitude: float) -> tuple[float, float]:
    """Return the metres in a degree of longitude and in one of latitude, on WGS 84.

    `latitude` is geodetic, in degrees, -90..90. Snyder 1987, p. 25: the radius of
    curvature along the meridian, eq. (4-18), and of the prime vertical, eq. (4-20);
    a and f of the ellipsoid from NIMA TR8350.2 (2000), table 3.1.
    """
    a, f = 6378137.0, 1.0 / 298.257223563
    e2 = f * (2.0 - f)
    phi = math.radians(latitude)
    w2 = 1.0 - e2 * math.sin(phi) ** 2
    meridian = a * (1.0 - e2) / w2**1.5
    prime_vertical = a / math.sqrt(w2)
    return math.radians(prime_vertical * math.cos(phi)), math.radians(meridian)


def spacing_from_degrees(
    dx: float, dy: float, latitude: float
) -> tuple[tuple[float, float] | None, tuple[str, ...]]:
    """Return the metres of a texel of ``dx`` by ``dy`` degrees at a latitude, None near a pole, and notes."""
    if abs(latitude) > 89.9:
        return None, (f"its middle latitude is {latitude:.6g} degrees, so its spacing is unknown",)
    east, north = degree_lengths(latitude)
    return (dx * east, dy * north), ()
