"""What the tests of terrain share: where a latitude and a longitude are in space."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import pytest


@pytest.fixture
def on_ellipsoid() -> Callable[[float, float], np.ndarray]:
    """Give a function from degrees to metres in space, on WGS 84."""

    def point(latitude: float, longitude: float) -> np.ndarray:
        """Return the point in space: the ellipse x²/a² + z²/b² = 1 by its reduced latitude."""
        a, b = 6378137.0, 6356752.314245
        reduced = math.atan(b / a * math.tan(math.radians(latitude)))
        around = math.radians(longitude)
        flat = a * math.cos(reduced)
        return np.array([flat * math.cos(around), flat * math.sin(around), b * math.sin(reduced)])

    return point
