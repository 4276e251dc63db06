"""Write values as GLSL has them."""

from __future__ import annotations

from collections.abc import Sequence

from playground.sketch.model import Parameter, Value


def literal(kind: str, value: Value) -> str:
    """Return a value of a GLSL type as a constant expression."""
    if isinstance(value, tuple | list):
        scalar = {"i": "int", "u": "uint"}.get(kind[0], "float")
        return f"{kind}({', '.join(literal(scalar, number) for number in value)})"
    if kind == "bool":
        return "true" if value else "false"
    if kind == "float":
        return number(float(value))
    return f"{int(value)}u" if kind == "uint" else str(int(value))


def number(value: float) -> str:
    """Return a float that no compiler takes for a whole number."""
    text = repr(float(value))
    return text if any(mark in text for mark in ".e") else f"{text}.0"


def vector(values: Sequence[float]) -> str:
    """Return a vec2 to vec4."""
    return f"vec{len(values)}({', '.join(map(number, values))})"


def meaning(parameter: Parameter) -> str:
    """Return what a parameter may be, and is for, as a comment says it."""
    widget = parameter.widget
    parts = []
    if widget.choices:
        parts.append(", ".join(f"{index} {choice}" for index, choice in enumerate(widget.choices)))
    elif widget.low is not None and widget.high is not None:
        parts.append(f"{widget.low:g} to {widget.high:g}")
    elif widget.kind == "direction":
        parts.append("azimuth, elevation in degrees")
    elif widget.kind == "colour":
        parts.append("linear light")
    if parameter.unit and widget.kind != "direction":
        parts.append(parameter.unit)
    return ": ".join(filter(None, [" ".join(parts), parameter.tooltip]))
