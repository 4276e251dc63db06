"""Format a parameter's value for a reader."""

from __future__ import annotations

from playground.lessons.model import Slider
from playground.sketch.assign import resolve
from playground.sketch.model import Value
from playground.sketch.values import write


def spelled_value(slider: Slider, value: Value, language: str) -> str:
    """Return a value of a slider's parameter: menu choices by name, numbers with their unit."""
    parameter = resolve(slider.scenes[0].sketch.graph, slider.parameter)[0].parameter
    text = write(parameter, value).replace(",", "; ")
    if language == "fr" and parameter.widget.kind not in ("menu", "file"):
        text = text.replace(".", ",")
    if parameter.unit:
        return f"{text}\u202f{parameter.unit}"
    return f"{text}°" if parameter.widget.kind in ("angle", "direction") else text
