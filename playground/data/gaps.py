"""Span the gaps in real terrain, where its file has no data."""

from __future__ import annotations

from dataclasses import replace
from typing import Literal

import numpy as np
from numpy.typing import NDArray

from playground.data.elevation import Elevation
from playground.data.grid import Heights
from playground.errors import DataError, nearest

Voids = Literal["refuse", "fill"]


def fill_no_data(elevation: Elevation, mode: Voids = "refuse") -> Elevation:
    """Return the elevation without gaps; itself, if it has none.

    `"refuse"` makes a gap an error; `"fill"` spans gaps with a smooth sheet that
    meets the terrain around them (see `_filled`), and leaves every known height as it is.

    Raises:
        DataError: gaps, under "refuse", with their number and the first one's texel;
            another mode.
    """
    if mode not in ("refuse", "fill"):
        raise DataError(f"no such way with gaps: {mode!r}{nearest(str(mode), ('refuse', 'fill'))}")
    if not elevation.missing:
        return elevation
    if mode == "refuse":
        y, x = np.unravel_index(int(np.argmax(np.isnan(elevation.heights))), elevation.heights.shape)
        raise DataError(
            f"{elevation.missing} of {elevation.heights.size} texels have no data, the first at ({x}, {y}) "
            'from the south-west corner; expected none, or no_data = "fill"',
            file=elevation.path or elevation.name,
        )
    heights = _filled(elevation.heights)
    heights.setflags(write=False)
    note = f"{elevation.missing} texels without data were filled from their surroundings"
    return replace(elevation, heights=heights, notes=(*elevation.notes, note))


def _filled(heights: Heights) -> Heights:
    # Solve Laplace's equation in the gaps (free at the edges of the terrain), coarse to fine: the
    # pull and push of Gortler et al. 1996, "The Lumigraph", section 3.4, starts each level, a few
    # Gauss-Seidel sweeps finish it: the cascade of Bornemann and Deuflhard 1996.
    known = ~np.isnan(heights)
    with np.errstate(all="ignore"):
        level = np.where(known, heights, np.float32(0.0)).astype(np.float64)
        middle = level.sum() / np.count_nonzero(known)
        level[known] -= middle
        levels = [(level, known)]
        while not known.all():
            level, known = _halved(level, known)
            levels.append((level, known))
        coarse = levels.pop()[0]
        while levels:
            level, known = levels.pop()
            gaps = np.argwhere(~known)
            level[~known] = _interpolated(coarse, gaps)
            _relax(level, gaps)
            coarse = level
        result = heights.copy()
        gap = np.isnan(heights)
        result[gap] = coarse[gap] + middle
    return result


def _halved(
    level: NDArray[np.float64], known: NDArray[np.bool_]
) -> tuple[NDArray[np.float64], NDArray[np.bool_]]:
    # Means of the known among each 2 x 2; level is 0 where unknown.
    pad = [(0, n % 2) for n in level.shape]
    total, count = np.pad(level, pad), np.pad(known, pad).astype(np.uint8)
    total = total[::2] + total[1::2]
    total = total[:, ::2] + total[:, 1::2]
    count = count[::2] + count[1::2]
    count = count[:, ::2] + count[:, 1::2]
    return total / np.maximum(count, 1), count > 0


def _interpolated(coarse: NDArray[np.float64], texels: NDArray[np.intp]) -> NDArray[np.float64]:
    # Bilinear, where fine texel i lies at coarse (i - 0.5) / 2: 3/4 of its own cell, 1/4 of the next.
    own = texels // 2
    other = np.clip(own + np.where(texels % 2, 1, -1), 0, np.array(coarse.shape) - 1)
    (oy, ox), (ny, nx) = own.T, other.T
    return np.asarray(
        0.5625 * coarse[oy, ox] + 0.1875 * (coarse[ny, ox] + coarse[oy, nx]) + 0.0625 * coarse[ny, nx]
    )


def _relax(level: NDArray[np.float64], gaps: NDArray[np.intp]) -> None:
    rows, cols = level.shape
    flat = level.reshape(-1)
    y, x = gaps.T
    here = y * cols + x
    around = (
        np.where(y > 0, here - cols, here),
        np.where(y < rows - 1, here + cols, here),
        np.where(x > 0, here - 1, here),
        np.where(x < cols - 1, here + 1, here),
    )
    colour = (y + x) % 2 == 0
    halves = [(here[c], *(n[c] for n in around)) for c in (colour, ~colour)]
    # Coarse levels carry the error that is slow to go, and cost next to nothing.
    for _ in range(min(64, max(8, 1_000_000 // len(here)))):
        for centre, s, n, w, e in halves:
            flat[centre] = 0.25 * (flat[s] + flat[n] + flat[w] + flat[e])
