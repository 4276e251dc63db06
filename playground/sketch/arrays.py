"""Arrays as values: their grid by xarray's coordinates, and the file each is copied into.

By its attributes, without xarray: ``dims``, ``coords``, and rioxarray's accessor ``rio`` where it is there.

So a sketch stays a frozen value of text and numbers: what is hashed, cached, sent to another process,
exported and copied is that file. It is written once, is read-only, is named by its contents, and goes when
no sketch of this process names it any more. A sketch that is pickled takes the contents along.

A grid of heights has row 0 in the south, as all that an engine reads; rows of an xarray.DataArray go
where its coordinates say. A picture has its top row first, as all pictures.
"""

from __future__ import annotations

import atexit
import hashlib
import io
import os
import re
import shutil
import tempfile
import weakref
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from playground.errors import ParameterError
from playground.shader.parameter import MAX_SIDE, Parameter

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
        """Return what an ``.npz`` says of it, as ``data.arrays`` reads it."""
        arrays: dict[str, Any] = {"height_units": self.height_units} if self.height_units else {}
        if self.step is None or self.x is None or self.y is None:
            return arrays
        arrays |= {"dx": self.step[0], "dy": self.step[1]}
        arrays |= {"xmin": self.x[0], "xmax": self.x[1], "ymin": self.y[0], "ymax": self.y[1]}
        return arrays | {"units": self.units} | ({"crs": self.crs} if self.crs else {})


def is_labelled(value: object) -> bool:
    """Return whether an array has named dimensions and coordinates, as xarray's have."""
    return hasattr(value, "dims") and hasattr(value, "coords")


def coordinates_of(
    value: Any, values: NDArray[Any], name: str
) -> tuple[NDArray[Any], Coordinates, float | None]:
    """Return (ny, nx) with row 0 in the south and column 0 in the west, where it lies, and its gaps' number.

    Raises ``ParameterError`` for coordinates that are not evenly spaced, or in a unit that is none of length.
    """
    dims = [str(dim) for dim in value.dims]
    single = [k for k, count in enumerate(values.shape) if count == 1 and values.ndim > 2]
    values = values.squeeze(tuple(single))
    dims = [dim for k, dim in enumerate(dims) if k not in single]
    accessor = getattr(value, "rio", None)
    gap = getattr(accessor, "nodata", None)
    gap = None if gap is None or np.isnan(gap) else float(gap)
    unit = str(_attributes(value).get("units", "")).strip()[:_MAX_UNIT]
    if values.ndim != 2:
        return values, Coordinates(), gap
    if dims[0].lower() in _EAST and dims[1].lower() not in _EAST:
        values, dims = values.T, dims[::-1]
    x, y = (_along(value, dims[k], count, name) for k, count in ((1, values.shape[1]), (0, values.shape[0])))
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
    scale, degrees = _unit(value, dims, name)
    x, y, step = ((pair[0] * scale, pair[1] * scale) for pair in (x, y, step))
    return values, Coordinates(x, y, step, "degrees" if degrees else "m", "", unit), gap


def _along(labelled: Any, dim: str, count: int, name: str) -> tuple[float, float] | None:
    """Return the first and last coordinate along a dimension; None where it has none that are numbers."""
    if dim not in labelled.coords or count < 2:
        return None
    filtered = np.asarray(labelled.coords[dim])
    if filtered.dtype.kind not in "iuf" or filtered.shape != (count,):
        return None
    places = filtered.astype(np.float64)
    steps = np.diff(places)
    mean = (places[-1] - places[0]) / (count - 1)
    if not np.isfinite(mean) or mean == 0.0 or not (np.abs(steps - mean) <= _EVEN * abs(mean)).all():
        low, high = steps.min(), steps.max()
        raise ParameterError(
            f"{name}: the coordinates '{dim}' are {low:g} to {high:g} apart; a grid that is evenly spaced "
            "was expected, as DataArray.interp makes of it"
        )
    return float(places[0]), float(places[-1])


def _unit(labelled: Any, dims: list[str], name: str) -> tuple[float, bool]:
    """Return metres in a unit of the coordinates, and whether they are degrees instead."""
    words = {str(_attributes(labelled.coords[dim]).get("units", "")).strip().lower() for dim in dims}
    if dims[1].lower() in ("lon", "longitude") or any(word.startswith(_DEGREES) for word in words):
        return 1.0, True
    if len(words) > 1 or not words <= set(_METRES):
        unit_text = " and ".join(sorted(words))
        raise ParameterError(f"{name}: coordinates in '{unit_text}'; expected m, km or degrees")
    return _METRES[words.pop()], False


def _attributes(labelled: Any) -> Mapping[str, Any]:
    attributes = getattr(labelled, "attrs", {})
    return attributes if isinstance(attributes, Mapping) else {}


GRIDS = ("elevation_file", "example_file", "numbers_file", "vector_file")
"""The sources one of whose files is a grid of heights, or of other numbers."""

PICTURES = ("", "mask_file")
"""The sources whose file is a picture; "": a kernel's own image."""

_VECTORS = "vectors"  # the parameter of a source of a grid that names no grid
_SIDES = (1, 3, 4)  # numbers a pixel
_EXACT = (np.uint8, np.uint16, np.float32)


class ArrayFile(str):
    """The path of a file that holds an array: the file goes with the last of it."""

    __slots__ = ("__weakref__",)

    def __reduce__(self) -> tuple[Any, ...]:
        path = Path(self)
        return _stored, (path.name.rpartition("-")[0], path.suffix, path.read_bytes())


class _Folder:
    """Where this process has its arrays; made with the first."""

    def __init__(self) -> None:
        self.owner = 0
        self.files: weakref.WeakValueDictionary[str, ArrayFile] = weakref.WeakValueDictionary()
        self._made = Path()

    @property
    def path(self) -> Path:
        """Return the folder's path; of a process that was forked another one than its parent's."""
        if self.owner != os.getpid():
            self.owner, self.files = os.getpid(), weakref.WeakValueDictionary()
            self._made = Path(tempfile.mkdtemp(prefix="playground-arrays-"))
            atexit.register(_clear, self._made, self.owner)
        return self._made


def _clear(folder: Path, owner: int) -> None:
    if owner == os.getpid():
        shutil.rmtree(folder, ignore_errors=True)


_folder = _Folder()


def holds_array(path: str | Path) -> bool:
    """Return whether a path is that of an array's file in this process."""
    return str(path) in _folder.files


def stored(value: object, parameter: Parameter, registry: str, name: str) -> ArrayFile:
    """Return the path of a file that holds an array, for a ``parameter`` of a source of ``registry``.

    ``name`` is what messages call it. Raises ``ParameterError`` where it takes no array, or another one.
    """
    if registry in GRIDS and parameter.name != _VECTORS:
        label, ending, data = _grid(value, name)
    elif registry in PICTURES:
        label, ending, data = _picture(value, name)
    else:
        raise ParameterError(f"{name}: takes a file of its own kind, as {parameter.default}, and no array")
    return _stored(label, ending, data)


def texels(value: object, name: str) -> tuple[ArrayFile, tuple[int, int, int]]:
    """Return a file of a texture's numbers and their shape, (ny, nx, 1, 2 or 4), row 0 in the south.

    Of three numbers a texel the fourth is 1. Raises ``ParameterError`` for what is no texture.
    """
    values = _values(value, name)
    if is_labelled(value):
        values, _, gap = coordinates_of(value, values, name)
        values = values if gap is None else _without(values, values == gap)
    values = values[..., None] if values.ndim == 2 else values
    if (
        values.dtype.kind not in "iufb"
        or values.ndim != 3
        or values.shape[2] not in (1, 2, 3, 4)
        or not all(1 <= side <= MAX_SIDE for side in values.shape[:2])
    ):
        raise ParameterError(
            f"{name} = {_shape(values)}: expected numbers (ny, nx) or (ny, nx, 1 to 4), row 0 in the south"
        )
    values = values.astype(np.float32)
    if not np.isfinite(values).all():
        row, column = (int(n) for n in np.argwhere(~np.isfinite(values))[0][:2])
        raise ParameterError(f"{name}: the number at row {row}, column {column} is not finite")
    if values.shape[2] == 3:
        values = np.concatenate([values, np.ones((*values.shape[:2], 1), np.float32)], axis=2)
    stream = io.BytesIO()
    np.save(stream, np.ascontiguousarray(values), allow_pickle=False)
    return _stored("texels", ".npy", stream.getvalue()), values.shape


def _stored(label: str, ending: str, data: bytes) -> ArrayFile:
    digest = hashlib.blake2b(data, digest_size=16).hexdigest()
    path = _folder.path / f"{label}-{digest}{ending}"
    if file := _folder.files.get(str(path)):
        return file
    with tempfile.NamedTemporaryFile(dir=path.parent, delete=False) as handle:
        handle.write(data)
    Path(handle.name).chmod(0o444)
    Path(handle.name).replace(path)
    array_file = _folder.files[str(path)] = ArrayFile(path)
    weakref.finalize(array_file, _remove, str(path), os.getpid()).atexit = False
    return array_file


def _remove(path: str, owner: int) -> None:
    """Remove an array's file, but not in a process that was forked, nor where it is named again."""
    if owner == os.getpid() and path not in _folder.files:
        Path(path).unlink(missing_ok=True)


def _values(value: object, name: str) -> NDArray[Any]:
    try:
        if isinstance(value, np.ma.MaskedArray):
            return _without(np.asarray(value.data), np.ma.getmaskarray(value))
        return np.asarray(value)
    except Exception as error:  # an array of somebody else may raise anything
        text = " ".join(str(error).split()) or type(error).__name__
        raise ParameterError(f"{name}: this {type(value).__name__} gives no array: {text}") from None


def _without(values: NDArray[Any], gaps: NDArray[np.bool_]) -> NDArray[Any]:
    """Return an array with NaN in its gaps."""
    if not gaps.any():
        return values
    wide = values.dtype.kind != "f" and values.dtype.itemsize > 2
    array = values.astype(np.float64 if wide or values.dtype == np.float64 else np.float32)
    array[gaps] = np.nan
    return array


def _shape(values: NDArray[Any]) -> str:
    return f"an array of {values.dtype} {values.shape}"


def _grid(value: object, name: str) -> tuple[str, str, bytes]:
    """Return a label, an ending and the bytes of an ``.npz`` of a grid, which says how its rows lie."""
    label, coordinates = "array", Coordinates()
    values = _values(value, name)
    if is_labelled(value):
        values, coordinates, gap = coordinates_of(value, values, name)
        label = str(getattr(value, "name", None) or label)
        if gap is not None:
            values = _without(values, values == gap)
    if values.dtype.kind not in "iuf" or values.ndim != 2 or min(values.shape) < 2:
        raise ParameterError(
            f"{name} = {_shape(values)}: expected numbers (ny, nx), at least 2 x 2, row 0 in the south"
        )
    if values.dtype.kind == "f":
        values = values.astype(np.float32 if values.dtype.itemsize < 4 else f"<f{min(values.itemsize, 8)}")
        if np.isinf(values).any():
            row, column = (int(n) for n in np.argwhere(np.isinf(values))[0])
            raise ParameterError(f"{name}: the number at row {row}, column {column} is infinite")
        if np.isnan(values).all():
            raise ParameterError(f"{name}: no number of the array is there; all are NaN")
    return _label(label), ".npz", _npz({"elevation": values, "first_row": "south", **coordinates.arrays()})


def _picture(value: object, name: str) -> tuple[str, str, bytes]:
    """Return a label, an ending and the bytes of an ``.npy`` of a picture, top row first."""
    values = _values(value, name)
    label = str(getattr(value, "name", None) or "picture") if is_labelled(value) else "picture"
    if values.ndim == 2:
        values = values[..., None]
    if values.dtype.kind == "b":
        values = values.astype(np.uint8) * np.uint8(255)
    if values.dtype.kind == "f":
        values = values.astype(np.float32)
    if values.ndim != 3 or values.shape[2] not in _SIDES or 0 in values.shape or values.dtype not in _EXACT:
        raise ParameterError(
            f"{name} = {_shape(values)}: expected a picture (ny, nx), (ny, nx, 3) or (ny, nx, 4), top row "
            "first: uint8, uint16, or floats from 0 to 1"
        )
    # A NaN is outside, too.
    if values.dtype.kind == "f" and not (values.min() >= 0.0 and values.max() <= 1.0):
        raise ParameterError(
            f"{name}: numbers from {values.min():g} to {values.max():g}; a picture's floats are 0 to 1"
        )
    stream = io.BytesIO()
    np.save(stream, np.ascontiguousarray(values), allow_pickle=False)
    return _label(label), ".npy", stream.getvalue()


def _label(name: str) -> str:
    return re.sub(r"\W+", "_", name, flags=re.ASCII).strip("_")[:40] or "array"


def _npz(arrays: Mapping[str, Any]) -> bytes:
    stream = io.BytesIO()
    # Rows as they lie in memory: in one order, so that the same numbers give the same bytes.
    held: dict[str, Any] = {name: np.ascontiguousarray(value) for name, value in arrays.items()}
    np.savez(stream, **held)
    return stream.getvalue()
