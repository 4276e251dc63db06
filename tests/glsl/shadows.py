"""Shadows of ellipsoids on level ground, by rays to the sun in float64."""

from __future__ import annotations

from collections.abc import Iterable

import numpy as np
from numpy.typing import NDArray

SIDE = 512
"""Texels a side of the square around the eye."""


def shadows_of(
    eye: NDArray[np.float64],
    wide: float,
    forms: Iterable[tuple[NDArray[np.float64], NDArray[np.float64]]],
    azimuth: float,
    elevation: float,
) -> NDArray[np.bool_]:
    """Return which texels of a square ``wide`` metres around the eye lie in shadow (512, 512), row 0 south.

    ``forms``: of each ellipsoid its middle, east, north and over the ground there, and half its size [m].
    """
    turn, rise = np.radians([azimuth, elevation])
    to_sun = np.array([np.sin(turn) * np.cos(rise), np.cos(turn) * np.cos(rise), np.sin(rise)])
    metres = ((np.arange(SIDE) + 0.5) / SIDE - 0.5) * wide
    x, y = np.meshgrid(eye[0] + metres, eye[1] + metres)
    hidden = np.zeros((SIDE, SIDE), bool)
    for middle, half in forms:
        start = (np.stack([x, y, np.zeros_like(x)]) - middle[:, None, None]) / half[:, None, None]
        along = to_sun / half
        nearest = np.maximum(-np.tensordot(along, start, 1) / (along @ along), 0.0)
        hidden |= ((start + nearest * along[:, None, None]) ** 2).sum(axis=0) < 1.0
    return hidden
