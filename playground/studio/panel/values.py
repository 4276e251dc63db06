"""Numbers of the panel: how each is written, what a drag makes of it, what a person types.

Typed are numbers, expressions such as ``pi/4``, colours and names.
"""

from __future__ import annotations

import math

from playground.errors import ParameterError
from playground.shader.expressions import ExpressionError, evaluate_numbers
from playground.shader.parameter import coerce, is_whole
from playground.sketch.model import Parameter, Value


def decimals(parameter: Parameter) -> int:
    """Return the places after the point that suit a parameter: of its step, or a thousandth of its range."""
    if is_whole(parameter.type):
        return 0
    widget = parameter.widget
    if parameter.step:
        return _places(parameter.step)
    if widget.low is not None and widget.high is not None:
        fine = widget.low if widget.facts.is_log else (widget.high - widget.low) / 1000
        return _places(10.0 ** math.floor(math.log10(fine) + 1e-9)) if fine > 0 else 3
    return 3


def format_of(parameter: Parameter) -> str:
    """Return the C format that writes a parameter's number with its unit."""
    if is_whole(parameter.type):
        number = "%d"
    elif parameter.widget.facts.is_log:
        number = "%.4g"
    else:
        number = f"%.{decimals(parameter)}f"
    return number + unit_of(parameter).replace("%", "%%")


def unit_of(parameter: Parameter) -> str:
    """Return the unit as it follows a number: degrees close up, others after a space."""
    unit = parameter.unit or parameter.widget.facts.unit
    unit = "°" if unit == "degrees" else unit
    return unit if unit in ("", "°", "%") else f" {unit}"


def snapped(parameter: Parameter, value: float) -> float:
    """Return the nearest value that lies in the range, whole steps from its lower end."""
    widget = parameter.widget
    if parameter.step:
        start = widget.low or 0.0
        value = start + round((value - start) / parameter.step) * parameter.step
        value = round(value, _places(parameter.step) + 2)
    if widget.low is not None and widget.high is not None:
        value = min(max(value, widget.low), widget.high)
    return value


def _places(step: float) -> int:
    """Return the places after the point that a step needs, 6 at most."""
    for places in range(7):
        scaled = step * 10**places
        if abs(scaled - round(scaled)) < 1e-6 * max(scaled, 1.0) and round(scaled) != 0:
            return places
    return 6


NAMES = {"pi": math.pi, "tau": math.tau}
"""What an expression may name."""

_WORDS = ("menu", "file", "checkbox", "button")


def read_typed(parameter: Parameter, text: str, path: str) -> Value:
    """Return the value that a text means; several numbers are separated by commas.

    Raises ``ParameterError`` for what is no expression, and for a value that the parameter
    does not take: one outside its range, which ``--set`` and the sketch refuse as well.
    """
    text = text.strip()
    if parameter.widget.kind in _WORDS or text.startswith("#"):
        return coerce(parameter, text, path)
    try:
        numbers = evaluate_numbers(text, NAMES)
    except ExpressionError as error:
        raise ParameterError(f"{path}: {error}") from None
    whole = is_whole(parameter.type)
    result = [int(n) if whole and n.is_integer() else n for n in numbers]
    return coerce(parameter, result[0] if len(result) == 1 else result, path)
