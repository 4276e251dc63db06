"""What works out horizons and the sky over them elsewhere: a sweep along lines in Numba, and topocalc.

Both give the sky-view factor, cosine-weighted, from horizons in evenly spaced directions over
the full extent of the terrain. They are timed, and tell nothing about what is right.
"""

from __future__ import annotations

import math
from contextlib import suppress
from importlib import import_module
from typing import Any

import numpy as np

numba: Any = None
with suppress(ImportError):
    numba = import_module("numba")

viewf: Any = None
with suppress(ImportError):
    viewf = import_module("topocalc.viewf").viewf

SHIFT = 16  # a line drifts by whole 65536ths of a texel a row


def topocalc(heights: np.ndarray, spacing: float, directions: int) -> Any:
    """Return topocalc's sky-view factor (ny, nx); heights and spacing in metres."""
    return viewf(heights.astype(np.float64), spacing, nangles=directions)[0]


def numba_sweep(heights: np.ndarray, spacing: float, directions: int) -> np.ndarray:
    """Return the sky-view factor of level surfaces (ny, nx) by one sweep a direction, all processors."""
    total = np.zeros(heights.shape, np.float32)
    turned = np.ascontiguousarray(heights.T)
    total_turned = np.zeros(turned.shape, np.float32)
    for number in range(directions):
        angle = 2 * math.pi * number / directions
        east, north = math.sin(angle), math.cos(angle)
        along_rows = abs(east) >= abs(north) - 1e-12
        ahead, aside = (east, north) if along_rows else (north, east)
        _swept(
            heights if along_rows else turned,
            round(aside / abs(ahead) * (1 << SHIFT)),
            ahead > 0,
            np.float32(abs(ahead) / spacing),
            total if along_rows else total_turned,
        )
    return (total + total_turned.T) / directions


def _sweep(heights: Any, drift: int, upwards: bool, steep: Any, total: Any) -> None:
    """Add the squared cosine of each texel's horizon: lines run along the last axis.

    Each line keeps the upper hull of what it has passed (Timonen and Westerholm 2010).
    """
    across, rows = heights.shape
    half = 1 << (SHIFT - 1)
    top = ((rows - 1) * abs(drift) + half) >> SHIFT
    first = -top if drift > 0 else 0
    end = across + top if drift < 0 else across
    for line in numba.prange(first, end):
        tall = np.empty(rows + 1, np.float32)
        far = np.empty(rows + 1, np.float32)
        last = -1
        for row in range(rows - 1, -1, -1):
            at = line + ((row * drift + half) >> SHIFT)
            if at < 0 or at >= across:
                continue
            along = row if upwards else rows - 1 - row
            here = heights[at, along]
            position = np.float32(row)
            best = np.float32(-1e30)
            while last >= 0:
                slope = (tall[last] - here) / (far[last] - position)
                if slope < best:
                    break
                best = slope
                last -= 1
            if best > np.float32(-1e29):
                last += 1
            last += 1
            tall[last] = here
            far[last] = position
            tangent = max(best, np.float32(0)) * steep
            total[at, along] += np.float32(1) / (np.float32(1) + tangent * tangent)


_swept = numba.njit(parallel=True, fastmath=True, error_model="numpy")(_sweep) if numba else _sweep
