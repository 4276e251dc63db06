"""Move the lines that divide a picture with the mouse: parameters whose widget is a divider."""

from __future__ import annotations

from playground.sketch.assign import shown_parameters, value_of, values_of
from playground.sketch.model import Sketch

GRAB_DISTANCE = 6.0
"""How far from a line the mouse can grab it, in the screen's units."""


def dividers_of(sketch: Sketch) -> dict[str, float]:
    """Return where the lines are, in fractions of the picture's width from its left, by path."""
    leaves = values_of(sketch)
    dividers = {
        shown.path: value_of(sketch, shown.path, leaves)
        for shown in shown_parameters(sketch)
        if shown.exported and shown.parameter.widget.kind == "divider"
    }
    return {path: float(value) for path, value in dividers.items() if isinstance(value, int | float)}


def divider_at(sketch: Sketch, across: float, width: float) -> str:
    """Return the path of the line nearest to a place ``across`` a picture ``width`` wide, in the same units.

    "" where none is near enough.
    """
    away = {path: abs(share * width - across) for path, share in dividers_of(sketch).items()}
    nearest = min(away, key=away.__getitem__, default="")
    return nearest if nearest and away[nearest] <= GRAB_DISTANCE else ""


def moved(across: float, width: float) -> float:
    """Return where a line is when it is held at a place across the picture."""
    return round(min(max(across / width, 0.0), 1.0), 4)
