"""Elevation files that tests open."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import tifffile


def write_geotiff(path: Path, size: tuple[int, int] = (61, 41), epsg: int = 32633) -> Path:
    """Write hills of 10 x 12.5 m a texel in a projected reference system, and return the path."""
    keys = [1, 1, 1, 3, 1024, 0, 1, 1, 1025, 0, 1, 1, 3072, 0, 1, epsg]
    unit = '<Item name="UNITTYPE" sample="0" role="unittype">m</Item>'
    tags = [
        (33550, "d", 3, (10.0, 12.5, 0.0), True),
        (33922, "d", 6, (0.0, 0.0, 0.0, 400_000.0, 5_300_000.0, 0.0), True),
        (34735, "H", len(keys), tuple(keys), True),
        (42112, "s", 0, f"<GDALMetadata>{unit}</GDALMetadata>", True),
    ]
    south, east = np.mgrid[: size[1], : size[0]]
    hills = (500.0 + 60.0 * np.sin(south / 7.0) * np.cos(east / 9.0)).astype(np.float32)
    tifffile.imwrite(path, hills, extratags=tags, metadata=None, photometric="minisblack")
    return path


def spans_of_tiles(heights: np.ndarray) -> np.ndarray:
    """Return the lowest and highest heights of tiles, (ny, nx, 2), with where they end: all alike."""
    ny, nx = heights.shape[:2]
    ends = np.meshgrid(np.arange(1, nx + 1) / nx, np.arange(1, ny + 1) / ny)
    return np.concatenate([heights, np.stack(ends, axis=-1)], axis=-1).astype(np.float32)
