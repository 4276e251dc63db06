"""The sky drawn as a disc, so that a direction can be set by dragging a dot.

The middle is the zenith, the rim the horizon, north is up. Directions are azimuth
clockwise from north and elevation above the horizon, in degrees.
"""

from __future__ import annotations

import math


def dot_of(azimuth: float, elevation: float) -> tuple[float, float]:
    """Return the place of a direction on the unit disc: right, up. Below the horizon is on the rim."""
    radius = 1.0 - min(max(elevation, 0.0), 90.0) / 90.0
    angle = math.radians(azimuth)
    return radius * math.sin(angle), radius * math.cos(angle)


def direction_at(right: float, up: float) -> tuple[float, float]:
    """Return (azimuth, elevation) [degrees] of a place on the unit disc, or of the nearest on its rim."""
    radius = min(math.hypot(right, up), 1.0)
    azimuth = math.degrees(math.atan2(right, up)) % 360.0
    return azimuth, 90.0 * (1.0 - radius)
