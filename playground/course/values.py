"""Format a parameter's value for a reader."""

from __future__ import annotations

from playground.course.model import Scene, Slider
from playground.shader.parameter import write
from playground.sketch.assign import resolve
from playground.sketch.model import Value


def spelled_value(slider: Slider, value: Value, language: str) -> str:
    """Return a value of a slider's parameter: menu choices by name, numbers with their unit.

    A direction is "135°, 25°": azimuth and elevation. In French, whose numbers have a comma, a
    semicolon stands between the numbers of other vectors: "0,5 ; 2".
    """
    parameter = resolve(slider.scenes[0].sketch.graph, slider.parameter)[0].parameter
    kind = parameter.widget.kind
    text = write(parameter, value)
    if kind in ("menu", "file") or isinstance(value, str):
        return text
    comma = language == "fr"
    degrees = kind in ("angle", "direction") or parameter.unit in ("°", "degrees")
    parts = [part.replace(".", ",") if comma else part for part in text.split(",")]
    if degrees:
        return ", ".join(f"{part}°" for part in parts)
    joined = ("\u00a0; " if comma else ", ").join(parts)
    return f"{joined}\u202f{parameter.unit}" if parameter.unit else joined


def spelled_at(scene: Scene, path: str, value: Value) -> str:
    """Return a value of a parameter as the command line takes it."""
    if "." not in path:
        return str(value)
    return write(resolve(scene.sketch.graph, path)[0].parameter, value)
