"""Read a camera from a sketch's TOML."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from playground.errors import PlaygroundError
from playground.sketch.model import Camera
from playground.sketch.toml_keys import CAMERA
from playground.sketch.toml_places import Place
from playground.sketch.toml_table import TomlFile
from playground.sketch.values import spell

_LIMITS = {
    "azimuth": (-720, 720),
    "elevation": (-89, 89),
    "distance": (0, 1e9),
    "field_of_view": (5, 120),
}  # degrees, degrees, metres, degrees
_FARTHEST = 1e9  # [m] of a camera's target from the origin


def read_camera(file: TomlFile, table: Mapping[str, Any], default: Camera, place: Place) -> Camera:
    """Return what a table's ``camera`` says, and of the rest what ``default`` has; raise ``SketchError``."""
    given = file.take(table, "camera", dict, None, *place)
    if given is None:
        return default
    here = (*place, "camera")
    file.only(given, CAMERA, *here)
    numbers = {key: file.take(given, key, float, None, *here) for key in _LIMITS if key in given}
    return camera_of({**given, **numbers}, default, lambda key, message: file.error(message, *here, key))


def camera_of(
    given: Mapping[str, Any], default: Camera, error: Callable[[str, str], PlaygroundError]
) -> Camera:
    """Return a camera of some values by key, and of the rest what ``default`` has.

    Raises what ``error`` makes of a key and a message where a value is none or out of its range.
    """
    values: dict[str, Any] = {}
    for key, (low, high) in _LIMITS.items():
        number = given.get(key, getattr(default, key))
        if type(number) not in (int, float) or not low <= number <= high:
            number = f"{number:g}" if isinstance(number, float) else spell(number)
            raise error(key, f"{key} = {number}: expected {low:g} to {high:g}")
        values[key] = float(number)
    values["target"] = default.target
    if (target := given.get("target")) is not None:
        numbers = target if isinstance(target, list) else []
        good = len(numbers) == 3 and all(type(v) in (int, float) and abs(v) <= _FARTHEST for v in numbers)
        if not good:
            raise error("target", f"target = {spell(target)}: expected [east, north, up] in metres")
        values["target"] = tuple(float(v) for v in numbers)
    return Camera(**values)
