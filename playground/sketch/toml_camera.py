"""Read a camera from a sketch's TOML."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

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
    values: dict[str, Any] = {}
    for key, (low, high) in _LIMITS.items():
        number = file.take(given, key, float, getattr(default, key), *here)
        if not low <= number <= high:
            raise file.error(f"{key} = {number:g}: expected {low:g} to {high:g}", *here, key)
        values[key] = number
    values["target"] = default.target
    if "target" in given:
        target = given["target"]
        numbers = target if isinstance(target, list) else []
        good = len(numbers) == 3 and all(type(v) in (int, float) and abs(v) <= _FARTHEST for v in numbers)
        if not good:
            raise file.error(
                f"target = {spell(target)}: expected [east, north, up] in metres", *here, "target"
            )
        values["target"] = tuple(float(v) for v in numbers)
    return Camera(**values)
