"""Read and write GeoTIFF's keys, which say in which coordinate reference system a raster lies.

Keys that nothing here understands are carried along as they are. Source: OGC GeoTIFF 1.1 (OGC
19-008r4, 2019), clause 7 and annexes B and D.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from typing import Any

from playground.data.units import HEIGHTS_IN_FEET, METRE, UNITS
from playground.data.wkt import CrsFacts, read_wkt

Key = int | str | tuple[float, ...]
Keys = tuple[tuple[int, Key], ...]
"""Key → its value, in the order of their numbers."""

DIRECTORY, DOUBLES, WORDS = 34735, 34736, 34737
"""The tags that hold the keys, their real numbers, and their texts."""

MODEL, RASTER, CITATION = 1024, 1025, 1026
GEOGRAPHIC, ANGLE, PROJECTED, PROJECTED_CITATION, LENGTH, LENGTH_SIZE = 2048, 2054, 3072, 3073, 3076, 3077
VERTICAL, VERTICAL_UNIT = 4096, 4099
IS_AREA, IS_POINT = 1, 2
OWN = 32767  # defined by further keys, not by a code
_DEGREES = {9101: math.degrees(1.0), 9103: 1.0 / 60.0, 9104: 1.0 / 3600.0, 9105: 0.9, 9106: 0.9}
_ESRI_TEXT = "ESRI PE String = "  # before well-known text in a citation, where keys cannot say the system
_IN_METRES = (258, 269, 326, 327)  # hundreds of EPSG's codes of projected systems: UTM, all in metres


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
    height_unit, notes = _height_unit(known)
    if model == 2:
        degrees = _DEGREES.get(code(known, ANGLE), 1.0)
        return CrsFacts("geographic", degrees, _epsg(known, GEOGRAPHIC), height_unit, notes)
    if model == 1:
        epsg = _epsg(known, PROJECTED)
        unit, more = _cell_unit(known, epsg)
        return CrsFacts("projected", unit, epsg, height_unit, (*more, *notes))
    cited = read_wkt(str(known.get(PROJECTED_CITATION, "")).partition(_ESRI_TEXT)[2])
    return replace(cited, height_unit=height_unit or cited.height_unit, notes=notes)


def _cell_unit(known: Mapping[int, Key], epsg: int) -> tuple[float, tuple[str, ...]]:
    """Return the metres in a unit of a projected system, and notes; the code alone may imply the unit."""
    unit, size = code(known, LENGTH), known.get(LENGTH_SIZE)
    if unit == OWN and isinstance(size, tuple) and size[0] > 0.0:
        return size[0], ()
    if unit == 0 and epsg and epsg // 100 not in _IN_METRES:
        try:
            from rasterio import Env
            from rasterio.crs import CRS
            from rasterio.errors import CRSError
        except ImportError:
            return 1.0, (f"its keys do not say the unit of EPSG:{epsg}; a metre is assumed",)
        try:
            with Env():  # which logs what GDAL prints else
                return float(CRS.from_epsg(epsg).linear_units_factor[1]), ()
        except CRSError:
            return 1.0, (f"GDAL does not know EPSG:{epsg}; its unit is taken for a metre",)
    notes = () if unit in (0, *UNITS) else (f"its unit of length, EPSG {unit}, is taken for a metre",)
    return UNITS.get(unit, 1.0), notes


def _height_unit(known: Mapping[int, Key]) -> tuple[float, tuple[str, ...]]:
    """Return the metres in a unit of height, 0 where the keys do not say, and notes.

    The code of a vertical system says its unit; ``VERTICAL_UNIT`` is for systems without one, and for the
    codes of GeoTIFF 1.0 (5001 to 5199), which are ellipsoids and datums.
    """
    system, unit = code(known, VERTICAL), code(known, VERTICAL_UNIT)
    stated = UNITS.get(unit, 0.0)
    if not 0 < system < OWN or (5000 < system < 5200 and stated):
        notes = (f"its unit of height, EPSG {unit}, is not known here",) if unit and not stated else ()
        return stated, notes
    own = UNITS[HEIGHTS_IN_FEET.get(system, METRE)]
    if stated and stated != own:
        return own, (f"its keys name EPSG:{system} and another unit, EPSG {unit}; that of the former counts",)
    return own, ()


def _epsg(known: Mapping[int, Key], key: int) -> int:
    found = code(known, key)
    return found if found < OWN else 0


def keys_of_code(facts: CrsFacts) -> Keys:
    """Return keys for a system that has a code."""
    projected = facts.kind == "projected"
    where = PROJECTED if projected else GEOGRAPHIC
    return ((MODEL, 1 if projected else 2), (RASTER, IS_AREA), (where, facts.epsg))
