"""Read what an xarray.DataArray says of its grid: which way its rows go, their spacing and their CRS.

By its attributes, without xarray: ``dims``, ``coords``, and rioxarray's accessor ``rio`` where it is there.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import ParameterError

_EAST = ("x", "lon", "longitude", "easting", "projection_x_coordinate")
_METRES = {"": 1.0, "m": 1.0, "metre": 1.0, "metres": 1.0, "meter": 1.0, "meters": 1.0, "km": 1000.0}
_DEGREES = ("degree", "degrees", "deg")
_MAX_UNIT = 60  # letters of a unit's name
_EVEN = 1e-3  # of a spacing: what coordinates that were rounded may be off


@dataclass(frozen=True)
class Coordinates:
    """Where the nodes of a grid lie; None where nothing says."""

    x: tuple[float, float] | None = None  # of the westernmost and easternmost nodes
    y: tuple[float, float] | None = None  # of the southernmost and northernmost
    step: tuple[float, float] | None = None
    units: str = ""  # "m" or "degrees"
    crs: str = ""  # its well-known text
    height_units: str = ""  # the unit of the numbers, as it is named

    def arrays(self) -> dict[str, Any]:
        """Return what an ``.npz`` says of it, as ``terrain.arrays`` reads it."""
        found: dict[str, Any] = {"height_units": self.height_units} if self.height_units else {}
        if self.step is None or self.x is None or self.y is None:
            return found
        found |= {"dx": self.step[0], "dy": self.step[1]}
        found |= {"xmin": self.x[0], "xmax": self.x[1], "ymin": self.y[0], "ymax": self.y[1]}
        return found | {"units": self.units} | ({"crs": self.crs} if self.crs else {})


def is_labelled(given: object) -> bool:
    """Return whether an array has named dimensions and coordinates, as xarray's have."""
    return hasattr(given, "dims") and hasattr(given, "coords")


def coordinates_of(
    given: Any, values: NDArray[Any], name: str
) -> tuple[NDArray[Any], Coordinates, float | None]:
    """Return (ny, nx) with row 0 in the south and column 0 in the west, where it lies, and its gaps' number.

    Raises ``ParameterError`` for coordinates that are not evenly spaced, or in a unit that is none of length.
    """
    dims = [str(dim) for dim in given.dims]
    single = [k for k, count in enumerate(values.shape) if count == 1 and values.ndim > 2]
    values = values.squeeze(tuple(single))
    dims = [dim for k, dim in enumerate(dims) if k not in single]
    accessor = getattr(given, "rio", None)
    gap = getattr(accessor, "nodata", None)
    gap = None if gap is None or np.isnan(gap) else float(gap)
    unit = str(_attributes(given).get("units", "")).strip()[:_MAX_UNIT]
    if values.ndim != 2:
        return values, Coordinates(), gap
    if dims[0].lower() in _EAST and dims[1].lower() not in _EAST:
        values, dims = values.T, dims[::-1]
    x, y = (_along(given, dims[k], count, name) for k, count in ((1, values.shape[1]), (0, values.shape[0])))
    if x is not None and x[0] > x[1]:
        values, x = values[:, ::-1], x[::-1]
    if y is not None and y[0] > y[1]:
        values, y = values[::-1], y[::-1]
    if x is None or y is None:
        return values, Coordinates(height_units=unit), gap
    step = (x[1] - x[0]) / (values.shape[1] - 1), (y[1] - y[0]) / (values.shape[0] - 1)
    crs = getattr(accessor, "crs", None)
    if crs is not None:
        return values, Coordinates((x[0], x[1]), (y[0], y[1]), step, "", str(crs.to_wkt()), unit), gap
    scale, degrees = _unit(given, dims, name)
    x, y, step = ((pair[0] * scale, pair[1] * scale) for pair in (x, y, step))
    return values, Coordinates(x, y, step, "degrees" if degrees else "m", "", unit), gap


def _along(given: Any, dim: str, count: int, name: str) -> tuple[float, float] | None:
    """Return the first and last coordinate along a dimension; None where it has none that are numbers."""
    if dim not in given.coords or count < 2:
        return None
    found = np.asarray(given.coords[dim])
    if found.dtype.kind not in "iuf" or found.shape != (count,):
        return None
    places = found.astype(np.float64)
    steps = np.diff(places)
    mean = (places[-1] - places[0]) / (count - 1)
    if not np.isfinite(mean) or mean == 0.0 or not (np.abs(steps - mean) <= _EVEN * abs(mean)).all():
        low, high = steps.min(), steps.max()
        raise ParameterError(
            f"{name}: the coordinates '{dim}' are {low:g} to {high:g} apart; a grid that is evenly spaced "
            "was expected, as DataArray.interp makes of it"
        )
    return float(places[0]), float(places[-1])


def _unit(given: Any, dims: list[str], name: str) -> tuple[float, bool]:
    """Return metres in a unit of the coordinates, and whether they are degrees instead."""
    words = {str(_attributes(given.coords[dim]).get("units", "")).strip().lower() for dim in dims}
    if dims[1].lower() in ("lon", "longitude") or any(word.startswith(_DEGREES) for word in words):
        return 1.0, True
    if len(words) > 1 or not words <= set(_METRES):
        found = " and ".join(sorted(words))
        raise ParameterError(f"{name}: coordinates in '{found}'; expected m, km or degrees")
    return _METRES[words.pop()], False


def _attributes(labelled: Any) -> Mapping[str, Any]:
    found = getattr(labelled, "attrs", {})
    return found if isinstance(found, Mapping) else {}
