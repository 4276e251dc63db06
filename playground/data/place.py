"""Where terrain lies on the Earth: the corner, the steps and the reference system of its nodes.

A file's texels may stand for areas or for points; here each is a node, at the middle of its area, as
everywhere in the playground. So a grid of other nodes over the same terrain has the same outermost ones.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path

from playground.data.geodesy import spacing_from_degrees
from playground.data.geokeys import Keys, read_facts
from playground.data.units import height_unit
from playground.data.wkt import CrsFacts, read_wkt
from playground.errors import DataError

_WEB_MERCATOR = 3857
_EQUATOR = 6378137.0  # [m] radius of the sphere of Web Mercator


@dataclass(frozen=True)
class Crs:
    """A coordinate reference system, as the file says it: by GeoTIFF's keys, or by a text."""

    keys: Keys = ()
    wkt: str = ""

    @cached_property
    def facts(self) -> CrsFacts:
        """Return kind, unit and code."""
        return read_facts(self.keys) if self.keys else read_wkt(self.wkt)

    @property
    def name(self) -> str:
        """Return its code, as "EPSG:32633"; "" for one without."""
        return f"EPSG:{self.facts.epsg}" if self.facts.epsg else ""

    def height_unit(self, stated: str = "") -> tuple[float, str]:
        """Return the metres in a unit of heights, of which a file may state the name, and what is assumed."""
        facts = self.facts
        return height_unit(stated, facts.height_unit, facts.unit if facts.kind == "projected" else 0.0)


@dataclass(frozen=True)
class Place:
    """Where a grid of nodes lies, in the units of its reference system; rows go east."""

    west: float  # of the westernmost nodes
    north: float  # of the northernmost
    step: tuple[float, float]  # from node to node, east and south
    size: tuple[int, int]  # nodes
    crs: Crs = Crs()

    @property
    def bounds(self) -> tuple[float, float, float, float]:
        """Return west, south, east and north of the outermost nodes."""
        nx, ny = self.size
        return (
            self.west,
            self.north - (ny - 1) * self.step[1],
            self.west + (nx - 1) * self.step[0],
            self.north,
        )

    def step_at(self, size: tuple[int, int]) -> tuple[float, float]:
        """Return the steps of a grid of another size (nx, ny) over the same terrain."""
        if size == self.size:
            return self.step
        west, south, east, north = self.bounds
        return (east - west) / max(size[0] - 1, 1), (north - south) / max(size[1] - 1, 1)

    @property
    def spacing(self) -> tuple[tuple[float, float] | None, tuple[str, ...]]:
        """Return the metres from node to node, None where they are unknown, and notes."""
        facts = self.crs.facts
        dx, dy = (step * facts.unit for step in self.step)
        south, north = self.bounds[1], self.north
        middle = (south + north) / 2 * facts.unit
        if facts.kind == "geographic":
            if not math.isfinite(middle):
                return None, ("its texels are degrees at an unknown latitude",)
            spacing, notes = spacing_from_degrees(dx, dy, middle)
            return spacing, (*facts.notes, *notes)
        if facts.kind == "projected":
            if facts.epsg == _WEB_MERCATOR and math.isfinite(middle):
                # Web Mercator stretches by 1 / cos(latitude), which is cosh(y / R), since
                # y = R artanh(sin(latitude)): Snyder 1987, p. 41, eq. (7-2a).
                stretched = math.cosh(middle / _EQUATOR)
                dx, dy = dx / stretched, dy / stretched
            return (dx, dy), facts.notes
        return None, (*facts.notes, "it has a texel size but does not say whether that is metres")


def turned(path: Path, east: float, north: float) -> DataError:
    """Return the error of a grid whose rows do not go east, but so far east and north a texel."""
    angle = abs(math.degrees(math.atan2(north, east)))
    message = f"its rows go {angle:.4g} degrees off east; expected a grid that is not rotated"
    return DataError(f"{message}, as gdalwarp makes of it", file=path)
