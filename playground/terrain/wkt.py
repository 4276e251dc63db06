"""Read the coordinate reference system's text that .prj files and GDAL hold: kind, unit, EPSG code.

Source: OGC 12-063r5, "Well-known text representation of coordinate reference systems" (2015), and
the older form of OGC 01-009 that ESRI's .prj files keep to.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field

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
    notes: tuple[str, ...] = ()


def read_wkt(text: str) -> CrsFacts:
    """Return what a text says; nothing where it is not understood."""
    root = _parsed(text)
    crs = root.find((*_PROJECTED, *_GEOGRAPHIC)) if root is not None else None
    if crs is None:
        return CrsFacts()
    projected = crs.word in _PROJECTED
    unit = 1.0
    holders = [crs, *(node for node in crs.nodes() if node.word in ("CS", "AXIS"))]
    units = [node for holder in holders for node in holder.nodes() if node.word in _UNITS]
    if units:
        numbers = [value for value in map(_number, units[0].texts()[1:]) if value]
        if numbers:  # WKT gives radians, which become degrees
            unit = numbers[0] if projected else numbers[0] * 57.29577951308232
            unit = unit if projected or abs(unit - 1.0) > 1e-9 else 1.0
    return CrsFacts("projected" if projected else "geographic", unit, _epsg(crs))


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
