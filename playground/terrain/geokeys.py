"""Read and write GeoTIFF's keys, which say in which coordinate reference system a raster lies.

Keys that nothing here understands are carried along as they are. Source: OGC GeoTIFF 1.1 (OGC
19-008r4, 2019), clause 7 and annexes B and D.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from types import MappingProxyType
from typing import Any

from playground.terrain.wkt import CrsFacts

Key = int | str | tuple[float, ...]
Keys = tuple[tuple[int, Key], ...]
"""Key → its value, in the order of their numbers."""

DIRECTORY, DOUBLES, WORDS = 34735, 34736, 34737
"""The tags that hold the keys, their real numbers, and their texts."""

MODEL, RASTER, CITATION = 1024, 1025, 1026
GEOGRAPHIC, ANGLE, PROJECTED, PROJECTED_CITATION, LENGTH = 2048, 2054, 3072, 3073, 3076
VERTICAL, VERTICAL_UNIT = 4096, 4099
IS_AREA, IS_POINT = 1, 2
OWN = 32767  # defined by further keys, not by a code
METRE = 9001

UNITS: Mapping[int, float] = MappingProxyType({METRE: 1.0, 9002: 0.3048, 9003: 1200.0 / 3937.0, 9036: 1000.0})
"""Metres in a unit, by its EPSG code: metre, foot, US survey foot, kilometre."""


def read_keys(directory: Any, doubles: Any, words: Any) -> Keys:
    """Return the keys in three tags, each of which may be missing; what is damaged is left out."""
    numbers = [int(n) for n in directory] if directory is not None else []
    reals = [float(n) for n in _several(doubles)]
    text = str(words or "")
    found: dict[int, Key] = {}
    for k in range(4, len(numbers) - 3, 4):
        key, location, count, value = numbers[k : k + 4]
        if location == 0:
            found[key] = value
        elif location == DOUBLES and value + count <= len(reals):
            found[key] = tuple(reals[value : value + count])
        elif location == WORDS and value + count <= len(text) + 1:
            found[key] = text[value : value + count].rstrip("|\0")
    return tuple(sorted(found.items()))


def _several(values: Any) -> Sequence[Any]:
    if values is None:
        return ()
    return values if isinstance(values, tuple | list) else (values,)


def write_keys(keys: Keys) -> tuple[tuple[int, ...], tuple[float, ...], str]:
    """Return the directory, the real numbers and the text of some keys."""
    directory, reals, text = [1, 1, 1, len(keys)], list[float](), ""
    for key, value in sorted(keys):
        if isinstance(value, str):
            directory += [key, WORDS, len(value) + 1, len(text)]
            text += f"{value}|"
        elif isinstance(value, tuple):
            directory += [key, DOUBLES, len(value), len(reals)]
            reals += value
        else:
            directory += [key, 0, 1, value]
    return tuple(directory), tuple(reals), text


def with_keys(keys: Keys, changes: Mapping[int, Key | None]) -> Keys:
    """Return keys with some set, and those left out that are None."""
    found = {**dict(keys), **changes}
    return tuple(sorted((key, value) for key, value in found.items() if value is not None))


def code(keys: Mapping[int, Key], key: int, default: int = 0) -> int:
    """Return a key's number; the default where it is missing or no number."""
    value = keys.get(key, default)
    return value if isinstance(value, int) else default


def read_facts(keys: Keys) -> CrsFacts:
    """Return what the keys say of the coordinate reference system."""
    known = dict(keys)
    model = code(known, MODEL)
    if model == 2:
        degrees = math.degrees(1.0) if code(known, ANGLE) == 9101 else 1.0
        return CrsFacts("geographic", degrees, _epsg(known, GEOGRAPHIC))
    if model == 1:
        unit = code(known, LENGTH, METRE)
        notes = () if unit in UNITS else (f"its unit of length, EPSG {unit}, is taken for a metre",)
        return CrsFacts("projected", UNITS.get(unit, 1.0), _epsg(known, PROJECTED), notes)
    return CrsFacts()


def _epsg(known: Mapping[int, Key], key: int) -> int:
    found = code(known, key)
    return found if found < OWN else 0


def keys_of_code(facts: CrsFacts) -> Keys:
    """Return keys for a system that has a code."""
    projected = facts.kind == "projected"
    where = PROJECTED if projected else GEOGRAPHIC
    return ((MODEL, 1 if projected else 2), (RASTER, IS_AREA), (where, facts.epsg))
