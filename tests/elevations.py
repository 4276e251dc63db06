"""Elevation files that tests open."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import tifffile


def geotiff(
    path: Path,
    values: np.ndarray,
    keys: dict[int, int],
    scale: tuple[float, float] = (1.0, 1.0),
    tie: tuple[float, ...] = (0, 0, 0, 0, 0, 0),
    no_data: str = "",
    matrix: tuple[float, ...] = (),
    metadata: str = "",
) -> Path:
    """Write values, north row first, with GeoKeys and GDAL's items of metadata, and return the path."""
    directory = [1, 1, 0, len(keys), *(n for key, value in sorted(keys.items()) for n in (key, 0, 1, value))]
    place = [(33550, "d", 3, (*scale, 0.0), True), (33922, "d", 6, tie, True)]
    tags = [(34264, "d", 16, matrix, True)] if matrix else place
    tags += [(34735, "H", len(directory), directory, True)] if keys else []
    tags += [(42113, "s", 0, no_data, True)] if no_data else []
    tags += [(42112, "s", 0, f"<GDALMetadata>{metadata}</GDALMetadata>", True)] if metadata else []
    tifffile.imwrite(path, values, extratags=tags, metadata=None, photometric="minisblack")
    return path


def write_geotiff(path: Path, size: tuple[int, int] = (61, 41), epsg: int = 32633) -> Path:
    """Write hills of 10 x 12.5 m a texel in a projected reference system, and return the path."""
    south, east = np.mgrid[: size[1], : size[0]]
    hills = (500.0 + 60.0 * np.sin(south / 7.0) * np.cos(east / 9.0)).astype(np.float32)
    unit = '<Item name="UNITTYPE" sample="0" role="unittype">m</Item>'
    tie = (0.0, 0.0, 0.0, 400_000.0, 5_300_000.0, 0.0)
    return geotiff(path, hills, {1024: 1, 1025: 1, 3072: epsg}, (10.0, 12.5), tie, metadata=unit)


def spans_of_tiles(heights: np.ndarray) -> np.ndarray:
    """Return the lowest and highest heights of tiles, (ny, nx, 2), with where they end: all alike."""
    ny, nx = heights.shape[:2]
    ends = np.meshgrid(np.arange(1, nx + 1) / nx, np.arange(1, ny + 1) / ny)
    return np.concatenate([heights, np.stack(ends, axis=-1)], axis=-1).astype(np.float32)
