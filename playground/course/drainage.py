"""What lessons measure of the ways of water: numbers of a heightmap, or of the area that drains through it.

As in ``playground/course/measures.py``, ``values`` are float64 (ny, nx), row 0 in the south. Each texel
drains to its steepest neighbour (O'Callaghan and Mark 1984); the edges are outlets.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from playground.course.grid import Grid, Values

_NEAR = [(dy, dx) for dy in (-1, 0, 1) for dx in (-1, 0, 1) if dy or dx]
_KM2 = 1e6  # [m²]


def pits(values: Values, grid: Grid) -> float:
    """Return the fraction of the texels, borders aside, that no neighbour is lower than, 0..1."""
    slopes, _ = _ways(values, grid)
    return float((slopes[1:-1, 1:-1] <= 0).mean())


def tail_power(values: Values, grid: Grid, low: float, high: float) -> float:
    """Return τ of P(A > a) ~ a^−τ, of drained areas A [m²], fitted from ``low`` to ``high`` [km²].

    P is the fraction of the texels that drain more than a.
    """
    at = np.geomspace(low, high, 12) * _KM2 if 0 < low < high else np.empty(0)
    shares = np.array([(values > a).mean() for a in at])
    if not at.size or not shares.all():
        raise ValueError(f"low = {low:g}, high = {high:g}: expected areas [km²] that some texels exceed")
    return -float(np.polyfit(np.log(at), np.log(shares), 1)[0])


def slope_where_drained(values: Values, grid: Grid, low: float, high: float) -> float:
    """Return the median slope, in metres a metre, of the texels that drain ``low`` to ``high`` [km²]."""
    slopes, _ = _between(values, grid, low, high)
    if not slopes.size:
        raise ValueError(f"low = {low:g}, high = {high:g}: no texel drains that area (km²)")
    return float(np.median(slopes))


def slope_area_power(values: Values, grid: Grid, low: float, high: float) -> float:
    """Return θ of S ~ A^θ, fitted to the texels that drain ``low`` to ``high`` [km²]; S is the slope down."""
    slopes, areas = _between(values, grid, low, high)
    if np.unique(areas).size < 2:
        raise ValueError(f"low = {low:g}, high = {high:g}: fewer than two texels drain that area (km²)")
    return float(np.polyfit(np.log(areas), np.log(slopes), 1)[0])


def _between(values: Values, grid: Grid, low: float, high: float) -> tuple[Values, Values]:
    """Return the slopes above 0 and the areas of the texels that drain so much; edges have no slope."""
    slopes, receivers = _ways(values, grid)
    areas = _areas(values, receivers) * grid.spacing[0] * grid.spacing[1]
    chosen = (slopes > 0) & (areas >= low * _KM2) & (areas <= high * _KM2)
    return slopes[chosen], areas[chosen]


def _ways(values: Values, grid: Grid) -> tuple[Values, NDArray[np.intp]]:
    """Return the slope down to the steepest neighbour, and its number; 0 and the own number where none is."""
    ny, nx = values.shape
    numbers = np.arange(ny * nx).reshape(ny, nx)
    slopes, receivers = np.zeros((ny, nx)), numbers.copy()
    inner = slice(1, ny - 1), slice(1, nx - 1)
    for dy, dx in _NEAR:
        there = slice(1 + dy, ny - 1 + dy), slice(1 + dx, nx - 1 + dx)
        away = np.hypot(dy * grid.spacing[1], dx * grid.spacing[0])
        slope = grid.relief * (values[inner] - values[there]) / away
        receivers[inner] = np.where(slope > slopes[inner], numbers[there], receivers[inner])
        slopes[inner] = np.maximum(slopes[inner], slope)
    return slopes, receivers


def _areas(values: Values, receivers: NDArray[np.intp]) -> Values:
    """Return how many texels drain through each, itself included: handed on from the highest one down."""
    areas = np.ones(values.size)
    down = receivers.ravel()
    for cell in np.argsort(-values, axis=None, kind="stable"):
        if down[cell] != cell:
            areas[down[cell]] += areas[cell]
    return areas.reshape(values.shape)
