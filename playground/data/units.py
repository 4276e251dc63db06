"""Units of length: what GDAL, EPSG and well-known text call them, and how many metres each is.

Source: EPSG Geodetic Parameter Dataset, v12, units of measure and vertical reference systems.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from types import MappingProxyType

METRE = 9001
_FOOT, _SURVEY_FOOT = 0.3048, 1200.0 / 3937.0

UNITS: Mapping[int, float] = MappingProxyType(
    {
        1025: 0.001,  # millimetre
        1033: 0.01,  # centimetre
        METRE: 1.0,
        9002: _FOOT,
        9003: _SURVEY_FOOT,
        9005: 0.3047972654,  # Clarke's foot
        9014: 1.8288,  # fathom
        9030: 1852.0,  # nautical mile
        9031: 1.0000135965,  # German legal metre
        9033: 66.0 * _SURVEY_FOOT,  # US survey chain
        9034: 0.66 * _SURVEY_FOOT,  # US survey link
        9035: 5280.0 * _SURVEY_FOOT,  # US survey mile
        9036: 1000.0,
        9037: 0.9143917962,  # Clarke's yard
        9038: 20.1166195164,  # Clarke's chain
        9039: 0.201166195164,  # Clarke's link
        9040: 36.0 / 39.370147,  # British yard (Sears 1922)
        9041: 12.0 / 39.370147,  # British foot (Sears 1922)
        9042: 792.0 / 39.370147,  # British chain (Sears 1922)
        9043: 7.92 / 39.370147,  # British link (Sears 1922)
        9050: 0.9143992,  # British yard (Benoit 1895 A)
        9051: 0.9143992 / 3.0,  # British foot (Benoit 1895 A)
        9060: 36.0 / 39.370113,  # British yard (Benoit 1895 B)
        9061: 12.0 / 39.370113,  # British foot (Benoit 1895 B)
        9062: 792.0 / 39.370113,  # British chain (Benoit 1895 B)
        9063: 7.92 / 39.370113,  # British link (Benoit 1895 B)
        9070: 0.9144025 / 3.0,  # British foot (1865)
        9080: 12.0 / 39.370142,  # Indian foot
        9081: 0.30479841,  # Indian foot (1937)
        9082: 0.3047996,  # Indian foot (1962)
        9083: 0.3047995,  # Indian foot (1975)
        9084: 36.0 / 39.370142,  # Indian yard
        9093: 1609.344,  # statute mile
        9094: 6378300.0 / 20926201.0,  # Gold Coast foot
        9095: 0.3048007491,  # British foot (1936)
        9096: 0.9144,  # yard
        9097: 20.1168,  # chain
        9098: 0.201168,  # link
        9301: 20.116756,  # British chain (Sears 1922 truncated)
    }
)
"""Metres in a unit, by its EPSG code."""

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

HEIGHTS_IN_FEET: Mapping[int, int] = MappingProxyType(
    dict.fromkeys((5614, 6130, 6131, 6132, 8050, 8051, 8228, 8897), 9002)
    | dict.fromkeys((5702, 6358, 6359, 6360, 8052, 8053, 10919), 9003)
    | {5754: 9095}
)
"""The vertical systems of EPSG that are not in metres, and the codes of their units."""


def metres_in(name: str) -> float | None:
    """Return the metres in a unit of length by a name of it, in any case and spelling; None for another."""
    plain = re.sub(r"[\W_]", "", name.lower())
    return _METRES.get(plain) or _METRES.get(plain.removesuffix("s"))


def height_unit(stated: str, of_system: float, of_cells: float) -> tuple[float, str]:
    """Return the metres in a file's unit of height, and a note on what is assumed; "" for what it says.

    ``stated`` is the unit that the file names, "" for none; ``of_system`` is that of its vertical system,
    and ``of_cells`` that of its cells, in metres; 0 where there is none.
    """
    if stated.strip():
        metres = metres_in(stated)
        if metres is not None:
            return metres, ""
        return 1.0, f"its heights are in '{stated.strip()[:40]}', no unit of length here; metres are assumed"
    if of_system:
        return of_system, ""
    if 0.3 < of_cells < 0.31:  # feet: heights have the unit of the map, by custom
        metres, name = of_cells, "feet, as of its cells,"
    else:
        metres, name = 1.0, "metres"
    return metres, f"nothing says the unit of its heights; {name} are assumed"
