"""List the widgets of a ``//!`` annotation and what each takes: one row a widget.

How it is drawn is another table, in ``live/widgets.py``; a test compares the two.
"""

from __future__ import annotations

from dataclasses import dataclass

SCALARS = ("float", "int", "uint", "bool")
VECTORS = ("vec2", "vec3", "vec4", "ivec2", "ivec3", "ivec4", "uvec2", "uvec3", "uvec4")
_NUMBERS = ("float", "int", "uint", *VECTORS)


@dataclass(frozen=True, slots=True)
class Kind:
    """What is true of every parameter with one widget."""

    types: tuple[str, ...]  # GLSL types that it may be given to
    takes: str = ""
    """In brackets: "" nothing, range, "range or nothing", ranges, "raw or nothing", choices, sampling."""
    range: tuple[float, float] | None = None  # of each number, where the brackets give none
    expects: str = ""  # a value, in words; "": numbers of the type, in the range
    listed: str = ""  # a value, in a word or two of a table; "": its range
    unit: str = ""  # where the annotation gives none

    @property
    def bare(self) -> bool:
        """Whether it may be written without brackets."""
        return self.takes not in ("range", "choices")


WIDGETS: dict[str, Kind] = {
    "number": Kind(_NUMBERS),  # what has no widget; no word of an annotation
    "slider": Kind(_NUMBERS, "range"),
    "log_slider": Kind(("float", "int", "uint"), "range"),
    "angle": Kind(("float",), "range or nothing", range=(-360.0, 360.0), unit="°"),
    "divider": Kind(
        ("float",),
        range=(0.0, 1.0),
        expects="a share of the picture's width, from 0 to 1",
        listed="0 to 1",
    ),
    "direction": Kind(
        ("vec2",),
        expects="azimuth and elevation in degrees, as 135,25",
        listed="azimuth, elevation",
        unit="°",
    ),
    "colour": Kind(("vec3", "vec4"), "raw or nothing", expects="a colour, as #8a9a5b"),
    "menu": Kind(("int",), "choices"),
    "checkbox": Kind(("bool",), expects="true or false"),
    "button": Kind(("bool",), expects="true or false", listed="true while pressed"),
    "point": Kind(("vec2",), "ranges", range=(0.0, 1.0)),
    "file": Kind(("sampler2D",), "sampling", expects="the path of a file"),
}
"""By the word that asks for it in an annotation."""
