"""Where terrain lies on the Earth: its reference system, the corner and the steps of its nodes, its units.

A file's texels may stand for areas or for points; here each is a node, at the middle of its area, as
everywhere in the playground. So a grid of other nodes over the same terrain has the same outermost ones.
Reference systems are read by GDAL (rasterio), which is imported only where there is one to read.

Sources: Snyder 1987, "Map Projections: A Working Manual", USGS Professional Paper 1395; PROJ's schema of
PROJJSON v0.7 for the form of a reference system.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from playground.errors import DataError
from playground.files import reason
from playground.memo import TEXTS

if TYPE_CHECKING:
    from rasterio.crs import CRS

_WEB_MERCATOR = 3857
_EQUATOR = 6378137.0  # [m] radius of the sphere of Web Mercator
_FOOT, _SURVEY_FOOT = 0.3048, 1200.0 / 3937.0
_NAMES = {
    0.001: "mm millimetre millimeter",
    0.01: "cm centimetre centimeter",
    0.1: "dm decimetre decimeter",
    1.0: "m metre meter",
    1000.0: "km kilometre kilometer",
    0.0254: "in inch inches",
    _FOOT: "ft foot feet footintl feetintl ftintl internationalfoot internationalfeet footinternational "
    "feetinternational ftinternational",
    _SURVEY_FOOT: "usft ftus ussurveyfoot ussurveyfeet ussurveyft usfoot usfeet footus feetus surveyfoot "
    "surveyfeet footussurvey feetussurvey sft",
    0.9144: "yd yard",
    1.8288: "fath fathom",
    1609.344: "mi mile statutemile",
    1852.0: "nmi kmi nm nauticalmile",
}
_METRES = {name: metres for metres, names in _NAMES.items() for name in names.split()}
_KINDS = {
    "ProjectedCRS": "projected",
    "DerivedProjectedCRS": "projected",
    "EngineeringCRS": "projected",  # metres from a point of its own
    "GeographicCRS": "geographic",
    "DerivedGeographicCRS": "geographic",
    "GeodeticCRS": "geographic",
}


@contextmanager
def gdal() -> Iterator[None]:
    """Let GDAL work for itself: without the network, code in a VRT, or lines on the console."""
    import rasterio

    with rasterio.Env(
        CPL_VSIL_CURL_ALLOWED_EXTENSIONS="none",
        GDAL_CACHEMAX=2**26,  # [bytes] rows are read once
        GDAL_DISABLE_READDIR_ON_OPEN="YES",
        GDAL_GEOREF_SOURCES="PAM,INTERNAL,WORLDFILE",
        GDAL_HTTP_TIMEOUT="1",
        GDAL_VRT_ENABLE_PYTHON="NO",
        GDAL_VRT_ENABLE_RAWRASTERBAND="NO",
        PROJ_NETWORK="OFF",
    ):
        yield


# ── reference systems ────────────────────────────────────────────────────────


@dataclass(frozen=True, slots=True)
class CrsFacts:
    """What a file's terrain needs to know of its coordinate reference system."""

    kind: str = ""  # "projected", "geographic"; "" for another, and where there is none
    unit: float = 1.0  # metres, or degrees, in a unit
    epsg: int = 0  # of its horizontal part; 0: none is known
    height_unit: float = 0.0  # metres in a unit of its heights; 0: it says nothing of heights
    height_unit_name: str = ""


@dataclass(frozen=True)
class Crs:
    """A coordinate reference system as GDAL takes it: well-known text or a code; "" for none."""

    text: str = ""

    @property
    def facts(self) -> CrsFacts:
        """Return kind, units and code; nothing is known of what GDAL does not understand."""
        return _WGS_84_FACTS if self == WGS_84 else _facts(self.text)

    @property
    def name(self) -> str:
        """Return its code, as "EPSG:32633"; "" for one without."""
        return f"EPSG:{self.facts.epsg}" if self.facts.epsg else ""

    def resolve_height_unit(self, stated: str = "") -> tuple[float, str]:
        """Return the metres in a file's unit of height, and a note on what is assumed; "" for what it says.

        ``stated`` is the unit that the file names, "" for none; else that of its vertical system counts.
        """
        facts, stated = self.facts, stated.strip()
        if stated:
            metres = facts.height_unit if stated == facts.height_unit_name else metres_in(stated)
            if metres:
                return metres, ""
            return 1.0, f"its heights are in '{stated[:40]}', no unit of length here; metres are assumed"
        if facts.height_unit:
            return facts.height_unit, ""
        if facts.kind == "projected" and 0.3 < facts.unit < 0.31:  # by custom, heights have the map's unit
            metres, name = facts.unit, "feet, as of its cells,"
        else:
            metres, name = 1.0, "metres"
        return metres, f"nothing says the unit of its heights; {name} are assumed"


WGS_84 = Crs("EPSG:4326")
_WGS_84_FACTS = CrsFacts("geographic", 1.0, 4326)


def metres_in(name: str) -> float | None:
    """Return the metres in a unit of length by a name of it, in any case and spelling; None for another."""
    plain = re.sub(r"[\W_]", "", name.lower())
    return _METRES.get(plain) or _METRES.get(plain.removesuffix("s"))


def gdal_crs(text: str) -> CRS:
    """Return a reference system for GDAL, by a code as "EPSG:4326" or by well-known text.

    A text is never taken for the name of a file, or for an address.
    Raises ``DataError`` for one that GDAL does not know.
    """
    from rasterio.crs import CRS
    from rasterio.errors import CRSError

    code = re.fullmatch(r"([A-Za-z]+):(\w+)", text)
    try:
        with gdal():
            return CRS.from_authority(*code.groups()) if code else CRS.from_wkt(text)
    except (CRSError, ValueError) as error:
        why = reason(Exception(str(error)))
        raise DataError(f"GDAL does not know a reference system: {why}") from None


def horizontal(text: str) -> CRS:
    """Return a reference system without its heights."""
    from rasterio.crs import CRS

    crs = gdal_crs(text)
    with gdal():
        part = next(_parts(crs.to_dict(projjson=True)))
        return CRS.from_user_input(json.dumps(part))


@TEXTS.cached()
def _facts(text: str) -> CrsFacts:
    if not text:
        return CrsFacts()
    try:
        with gdal():
            flat, *others = _parts(gdal_crs(text).to_dict(projjson=True))
            axes, code = _axes(flat), flat.get("id", {})
            is_own = code.get("authority") == "EPSG"
            epsg = int(code["code"]) if is_own else horizontal(text).to_epsg() or 0
    except (DataError, LookupError, ValueError):  # what is no system, or one of no parts
        return CrsFacts()
    kind = _KINDS.get(flat["type"], "")
    if not axes or axes[0]["direction"].startswith("geocentric"):
        return CrsFacts()
    upward = [axis for axis in (*axes, *(a for part in others for a in _axes(part)))
              if axis["direction"] in ("up", "down")]  # fmt: skip
    height_unit, name = _unit(upward[0]) if upward else (0.0, "")
    unit = _unit(axes[0])[0]
    return CrsFacts(kind, math.degrees(unit) if kind == "geographic" else unit, epsg, height_unit, name)


def _parts(document: Mapping[str, Any]) -> Iterator[Mapping[str, Any]]:
    """Yield the simple systems that a document of PROJJSON is made of, the horizontal one first."""
    if document["type"] == "BoundCRS":
        yield from _parts(document["source_crs"])
    elif "components" in document:
        for component in document["components"]:
            yield from _parts(component)
    else:
        yield document


def _axes(part: Mapping[str, Any]) -> list[Mapping[str, Any]]:
    axes: list[Mapping[str, Any]] = part.get("coordinate_system", {}).get("axis", [])
    return axes


def _unit(axis: Mapping[str, Any]) -> tuple[float, str]:
    """Return the metres or radians in an axis's unit, and its name."""
    unit = axis["unit"]
    if isinstance(unit, str):
        return (math.radians(1.0) if unit == "degree" else 1.0), unit
    return float(unit["conversion_factor"]), str(unit["name"])


# ── places ───────────────────────────────────────────────────────────────────


@dataclass(frozen=True)
class Georeference:
    """Where a grid of nodes lies, in the units of its reference system; rows go east."""

    west: float  # of the westernmost nodes
    north: float  # of the northernmost
    step: tuple[float, float]  # from node to node, east and south
    size: tuple[int, int]  # nodes
    crs: Crs = Crs()
    is_point: bool = False  # the file's texels stand for points, as GeoTIFF says it

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
            return spacing_from_degrees(dx, dy, middle)
        if facts.kind == "projected":
            if facts.epsg == _WEB_MERCATOR and math.isfinite(middle):
                # Web Mercator stretches by 1 / cos(latitude), which is cosh(y / R), since
                # y = R artanh(sin(latitude)): Snyder 1987, p. 41, eq. (7-2a).
                stretched = math.cosh(middle / _EQUATOR)
                dx, dy = dx / stretched, dy / stretched
            return (dx, dy), ()
        return None, ("it has a texel size but does not say whether that is metres",)


def degree_lengths(latitude: float) -> tuple[float, float]:
    """Return the metres in a degree of longitude and in one of latitude, on WGS 84.

    `latitude` is geodetic, in degrees, -90..90. Snyder 1987, p. 25: the radius of
    curvature along the meridian, eq. (4-18), and of the prime vertical, eq. (4-20);
    a and f of the ellipsoid from NIMA TR8350.2 (2000), table 3.1.
    """
    a, f = 6378137.0, 1.0 / 298.257223563
    e2 = f * (2.0 - f)
    phi = math.radians(latitude)
    w2 = 1.0 - e2 * math.sin(phi) ** 2
    meridian = a * (1.0 - e2) / w2**1.5
    prime_vertical = a / math.sqrt(w2)
    return math.radians(prime_vertical * math.cos(phi)), math.radians(meridian)


def spacing_from_degrees(
    dx: float, dy: float, latitude: float
) -> tuple[tuple[float, float] | None, tuple[str, ...]]:
    """Return the metres of a texel of ``dx`` by ``dy`` degrees at a latitude, None near a pole, and notes."""
    if abs(latitude) > 89.9:
        return None, (f"its middle latitude is {latitude:.6g} degrees, so its spacing is unknown",)
    east, north = degree_lengths(latitude)
    return (dx * east, dy * north), ()
