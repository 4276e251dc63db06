"""Files next to a data file that say how to read it: without them it is another one, or none.

Sources: ESRI, "BIL, BIP, and BSQ raster files" (ArcGIS Desktop help); ESRI (1998), "Shapefile Technical
Description"; GDAL, "PAM (Persistent Auxiliary Metadata)".
"""

from __future__ import annotations

from pathlib import Path

AUXILIARY = ".aux.xml"
"""What GDAL appends to a raster's name, its ending included, for what the format has no place for."""

_ENDINGS = {
    ".asc": (".prj", AUXILIARY),
    ".bil": (".hdr", ".prj", AUXILIARY),
    ".flt": (".hdr", ".prj", AUXILIARY),
    ".tif": (AUXILIARY,),
    ".tiff": (AUXILIARY,),
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
    return tuple(
        path.with_name(path.name + form) if ending == AUXILIARY else path.with_suffix(form)
        for ending in endings
        for form in (ending, ending.upper())
    )
