"""Files next to a data file that say how to read it: without them it is another one, or none.

Sources: ESRI, "BIL, BIP, and BSQ raster files" (ArcGIS Desktop help); ESRI (1998), "Shapefile Technical
Description".
"""

from __future__ import annotations

from pathlib import Path

_ENDINGS = {
    ".asc": (".prj",),
    ".bil": (".hdr", ".prj"),
    ".flt": (".hdr", ".prj"),
    ".shp": (".shx", ".dbf", ".prj", ".cpg"),
}


def sidecars(path: Path) -> tuple[Path, ...]:
    """Return the files next to a data file that its readers look at, without those that are not there."""
    places = sidecar_places(path)
    pairs = zip(places[::2], places[1::2], strict=True)
    return tuple(found for pair in pairs if (found := next(filter(Path.is_file, pair), None)) is not None)


def sidecar_places(path: Path) -> tuple[Path, ...]:
    """Return where such files may lie: each by its ending in small letters, then in large ones."""
    endings = _ENDINGS.get(path.suffix.lower(), ())
    return tuple(path.with_suffix(form) for ending in endings for form in (ending, ending.upper()))
