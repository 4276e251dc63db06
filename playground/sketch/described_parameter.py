"""Describe a parameter as a panel outside of the window needs it: plain data, for JSON.

What a remote's page, a controller and a web page show of a parameter comes from here: its label, its
parts, the range of each, what it chooses from.
"""

from __future__ import annotations

from typing import Any

from playground.sketch.assign import Shown
from playground.sketch.model import Parameter
from playground.sketch.values import length_of
from playground.sketch.widgets import WIDGETS

_DIRECTION = ((0.0, 360.0), (0.0, 90.0))  # [degrees] azimuth, elevation: the sky


def described(shown: Shown) -> dict[str, Any]:
    """Return what is true of a parameter whatever its value is; ``ranges`` has one for each number."""
    parameter = shown.parameter
    names = part_names(parameter)
    return {
        "path": shown.path,
        "label": parameter.title,
        "pass": shown.path.partition(".")[0],
        "group": parameter.group,
        "description": parameter.tooltip,
        "widget": parameter.widget.kind,
        "type": parameter.type,
        "ranges": [range_of(parameter, part) for part in range(max(len(names), 1))],
        "step": parameter.step,
        "unit": parameter.unit or WIDGETS[parameter.widget.kind].unit,
        "choices": list(parameter.widget.choices),
        "parts": list(names),
        "exported": shown.exported,
    }


def part_names(parameter: Parameter) -> tuple[str, ...]:
    """Return what the parts of a vector are called; nothing for a scalar."""
    if length_of(parameter.type) == 1 or parameter.widget.kind == "file":
        return ()
    if parameter.parts:
        return parameter.parts
    if parameter.widget.kind == "direction":
        return ("azimuth", "elevation")
    return tuple(("rgba" if parameter.widget.kind == "colour" else "xyzw")[: length_of(parameter.type)])


def range_of(parameter: Parameter, part: int = 0) -> tuple[float, float] | None:
    """Return the range of a parameter's number, or of one of its parts; None where it has none."""
    if parameter.widget.kind == "direction":
        return _DIRECTION[part]
    low, high = parameter.widget.ends(part)
    if low is not None and high is not None:
        return low, high
    return WIDGETS[parameter.widget.kind].range
