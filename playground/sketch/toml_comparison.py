"""Read how a shot is compared from its table: ``tolerance`` and its ``reason``, ``mask``, ``allow_blank``."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from playground.errors import SketchError
from playground.sketch.allowed_files import is_absolute, leads_outside
from playground.sketch.flatten import flatten
from playground.sketch.model import Sketch
from playground.sketch.tolerance import Tolerance, tolerance_of
from playground.sketch.toml_places import Place
from playground.sketch.toml_table import TomlFile
from playground.sketch.values import spell

MASK_ENDING = ".png"
"""A mask's text that ends so is an image; another names a texture."""

Mask = tuple[tuple[int, int, int, int] | str, ...]


def read_comparison(file: TomlFile, sketch: Sketch, table: Mapping[str, Any], place: Place) -> dict[str, Any]:
    """Return the fields of a shot that say how it is compared; raise ``SketchError``."""
    return {
        "tolerance": _tolerance(file, table, place),
        "mask": _mask(file, sketch, table, place),
        "allow_blank": file.take(table, "allow_blank", bool, False, *place),
    }


def _tolerance(file: TomlFile, table: Mapping[str, Any], place: Place) -> Tolerance | None:
    reason = file.take(table, "reason", str, "", *place)
    if "tolerance" not in table and "reason" not in table:
        return None
    given = table.get("tolerance")
    if not isinstance(given, str | int | dict | None) or isinstance(given, bool):
        raise file.error(
            f"tolerance = {spell(given)}: expected a tier, levels, or a table", *place, "tolerance"
        )
    try:
        return tolerance_of(given, reason)
    except ValueError as error:
        raise file.error(str(error), *place, "tolerance" if "tolerance" in table else "reason") from None


def _mask(file: TomlFile, sketch: Sketch, table: Mapping[str, Any], place: Place) -> Mask:
    given = table.get("mask", [])
    items = given if isinstance(given, list) and not _is_rectangle(given) else [given]
    found: list[tuple[int, int, int, int] | str] = []
    for item in items:
        if _is_rectangle(item):
            found.append((item[0], item[1], item[2], item[3]))
        elif isinstance(item, str) and item.endswith(MASK_ENDING):
            _refuse_outside(file, sketch, item, place)
            found.append(item)
        elif isinstance(item, str):
            try:
                flatten(sketch).ref(item, sketch.name)
            except SketchError as error:
                raise file.error(f"mask: {error.diagnostics[0].message}", *place, "mask") from None
            found.append(item)
        else:
            message = (
                f"mask = {spell(item)}: expected [x, y, width, height] in pixels from the top left, "
                f'an image as "sky.png", a texture as "water:foam", or a list of such'
            )
            raise file.error(message, *place, "mask")
    return tuple(found)


def _is_rectangle(item: object) -> bool:
    numbers = isinstance(item, list) and len(item) == 4 and all(type(v) is int for v in item)
    return numbers and item[2] > 0 and item[3] > 0  # type: ignore[index]


def _refuse_outside(file: TomlFile, sketch: Sketch, text: str, place: Place) -> None:
    if is_absolute(text) or leads_outside(text, Path(sketch.folder)):
        raise file.error(f"mask = {spell(text)}: it leads outside the sketch's folder", *place, "mask")
