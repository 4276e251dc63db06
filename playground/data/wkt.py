"""Read the coordinate reference system's text that .prj files and GDAL hold: kind, unit, EPSG code.

Source: OGC 12-063r5, "Well-known text representation of coordinate reference systems" (2015), and
the older form of OGC 01-009 that ESRI's .prj files keep to.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from playground.data.units import metres_in

_TOKEN = re.compile(r'"((?:[^"]|"")*)"|([A-Za-z_][A-Za-z_0-9]*)\s*(?=[\[(])|([^\s,\[\]()"]+)|([\[(])|([\])])')
_PROJECTED = ("PROJCS", "PROJCRS", "PROJECTEDCRS")
_GEOGRAPHIC = ("GEOGCS", "GEOGCRS", "GEOGRAPHICCRS", "GEODCRS", "GEODETICCRS")
_ZONES = {
    ("WGS_1984", "N"): 32600,
    ("WGS_1984", "S"): 32700,
    ("NAD_1983", "N"): 26900,
    ("ETRS_1989", "N"): 25800,
}
_NAMES = {
    "GCS_WGS_1984": 4326,
    "GCS_North_American_1983": 4269,
    "WGS_1984_Web_Mercator_Auxiliary_Sphere": 3857,
}
_DEGREE = 0.017453292519943295  # [rad]
_VERTICAL = ("VERT_CS", "VERTCS", "VERTCRS", "VERTICALCRS")
_UNITS = ("UNIT", "LENGTHUNIT", "ANGLEUNIT")


@dataclass
class _Node:
    word: str
    parts: list[_Node | str] = field(default_factory=list)

    def nodes(self) -> Iterator[_Node]:
        """Yield the nodes right inside this one."""
        yield from (part for part in self.parts if isinstance(part, _Node))

    def texts(self) -> list[str]:
        """Return the texts and numbers right inside this node."""
        return [part for part in self.parts if isinstance(part, str)]

    def find(self, words: tuple[str, ...]) -> _Node | None:
        """Return the first node of one of these words, this one or the nearest inside."""
        level = [self]
        while level:
            found = next((node for node in level if node.word in words), None)
            if found is not None:
                return found
            level = [inner for node in level for inner in node.nodes()]
        return None


@dataclass(frozen=True, slots=True)
class CrsFacts:
    """What a file's terrain needs to know of its coordinate reference system."""

    kind: str = ""  # "projected", "geographic"; "" for another, and where there is none
    unit: float = 1.0  # metres, or degrees, in a unit
    epsg: int = 0  # 0: none is named
    height_unit: float = 0.0  # metres in a unit of its heights; 0: it says nothing of heights
    notes: tuple[str, ...] = ()


def read_wkt(text: str) -> CrsFacts:
    """Return what a text says; nothing where it is not understood."""
    root = _parsed(text)
    crs = root.find((*_PROJECTED, *_GEOGRAPHIC)) if root is not None else None
    if root is None or crs is None:
        return _read_lines(text)
    projected = crs.word in _PROJECTED
    unit = _unit(crs) or (1.0 if projected else _DEGREE)
    if not projected:  # WKT gives radians, which become degrees
        unit = unit / _DEGREE if abs(unit / _DEGREE - 1.0) > 1e-9 else 1.0
    return CrsFacts("projected" if projected else "geographic", unit, _epsg(crs), _height_unit(root, crs))


def _unit(crs: _Node, words: tuple[str, ...] = _UNITS) -> float:
    """Return the number of a system's first unit; 0 where it has none."""
    holders = [crs, *(node for node in crs.nodes() if node.word in ("CS", "AXIS"))]
    units = [node for holder in holders for node in holder.nodes() if node.word in words]
    return next((value for node in units[:1] for value in map(_number, node.texts()[1:]) if value), 0.0)


def _height_unit(root: _Node, crs: _Node) -> float:
    """Return the metres in a unit of height: of the vertical system, or of a third axis."""
    vertical = root.find(_VERTICAL) or next((axis for axis in crs.nodes() if _is_third(axis)), None)
    return _unit(crs, ("LINUNIT",)) if vertical is None else _unit(vertical)


def _is_third(axis: _Node) -> bool:
    return axis.word == "AXIS" and any(text.lower() == "up" for text in axis.texts()[1:])


def _read_lines(text: str) -> CrsFacts:
    """Return what a .prj in the form before well-known text says, as ARC/INFO wrote it: words and values."""
    lines = (line.lower().split() for line in text.splitlines())
    words = {line[0]: line[1] for line in lines if len(line) >= 2}
    height_unit = metres_in(words.get("zunits", "")) or 0.0
    if words.get("projection") == "geographic":
        return CrsFacts("geographic", 1.0 / 3600.0 if words.get("units") == "ds" else 1.0, 0, height_unit)
    unit = metres_in(words.get("units", ""))
    if "projection" not in words or unit is None:
        return CrsFacts(height_unit=height_unit)
    return CrsFacts("projected", unit, 0, height_unit)


def _epsg(crs: _Node) -> int:
    """Return the code that is named, or that of a system which ESRI names without one."""
    for node in crs.nodes():
        texts = node.texts()
        if node.word in ("AUTHORITY", "ID") and len(texts) >= 2 and texts[0].upper() == "EPSG":
            return int(texts[1]) if texts[1].isdecimal() else 0
    name = crs.texts()[0] if crs.texts() else ""
    zone = re.fullmatch(r"(\w+)_UTM_Zone_([1-9]|[1-5]\d|60)([NS])", name)
    if zone:
        base = _ZONES.get((zone[1], zone[3]), 0)
        return base + int(zone[2]) if base else 0
    return _NAMES.get(name, 0)


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return 0.0


def _parsed(text: str) -> _Node | None:
    root = _Node("")
    stack = [root]
    pending = ""
    for quoted, word, bare, opened, closed in _TOKEN.findall(text):
        if word:
            pending = word.upper()
        elif opened:
            node = _Node(pending)
            stack[-1].parts.append(node)
            stack.append(node)
        elif closed:
            if len(stack) == 1:
                return None
            stack.pop()
        else:
            stack[-1].parts.append(bare or quoted)
    return root if root.parts and len(stack) == 1 else None
