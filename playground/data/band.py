"""What GDAL's metadata say of a raster: the unit, scale and offset of its first band, its reference system.

In a TIFF they are XML in tag 42112; of any file, in the ``.aux.xml`` next to it. Source: GDAL's documentation
of the GTiff driver and of the PAM format (persistent auxiliary metadata).
"""

from __future__ import annotations

import html
import math
import re
from dataclasses import dataclass
from pathlib import Path

from playground.allowed_files import AUXILIARY, sidecars
from playground.errors import DataError

_MAX_BYTES = 2**24


@dataclass(frozen=True)
class BandFacts:
    """What the numbers of a band mean: number * scale + offset, in a unit."""

    unit: str = ""  # as it is named; "" where it is not
    scale: float = 1.0
    offset: float = 0.0

    @property
    def is_default(self) -> bool:
        """Return whether nothing is said."""
        return self == BandFacts()


def band_facts(path: Path, tag: str = "") -> BandFacts:
    """Return the facts of a file's first band; what the file next to it says counts more than its own tag."""
    items: dict[str, str] = {}
    for attributes, value in re.findall(r"<Item\b([^>]*)>([^<]*)</Item>", tag):
        role = re.search(r'\brole="(scale|offset|unittype)"', attributes)
        if role and not re.search(r'\bsample="(?!0")', attributes):
            items[role[1]] = value
    band = re.search(r'<PAMRasterBand\s+band="1"[^>]*>(.*?)</PAMRasterBand>', _beside(path), re.DOTALL)
    for name, value in re.findall(r"<(UnitType|Scale|Offset)>([^<]*)</", band[1] if band else ""):
        items[name.lower()] = value
    scale, offset = (_number(items.get(name), usual) for name, usual in (("scale", 1.0), ("offset", 0.0)))
    if not (math.isfinite(scale) and math.isfinite(offset) and scale):
        raise DataError("says that its numbers have a scale or an offset that is no number", file=path)
    return BandFacts(items.get("unittype", "").strip(), scale, offset)


def system_beside(path: Path) -> str:
    """Return the well-known text of a reference system that the file next to it states; "" for none."""
    found = re.search(r"<SRS\b[^>]*>([^<]*)</SRS>", _beside(path))
    return html.unescape(found[1]) if found else ""


def _beside(path: Path) -> str:
    """Return the text of the ``.aux.xml`` next to a file; "" where there is none."""
    beside = next((file for file in sidecars(path) if file.name.lower().endswith(AUXILIARY)), None)
    if beside is None or beside.stat().st_size > _MAX_BYTES:
        return ""
    return beside.read_text("utf-8", "replace")


def _number(text: str | None, usual: float) -> float:
    if text is None:
        return usual
    try:
        return float(text)
    except ValueError:
        return math.nan
