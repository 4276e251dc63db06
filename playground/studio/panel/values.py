"""Numbers of the panel: how each is written, what a drag makes of it, what is typed, fractions of a range.

Typed are numbers, expressions such as ``pi/4``, colours and names.

A fraction of a range is linear, logarithmic where its scale is, in equal stretches for a menu, from the
half on for a checkbox. A colour's channels are display-encoded, as the panel shows them. A vector has one
fraction for each part.
"""

from __future__ import annotations

import math
import re

from playground.errors import ParameterError
from playground.shader.colours import linear_to_srgb, srgb_to_linear
from playground.shader.expressions import ExpressionError, evaluate_numbers
from playground.shader.parameter import coerce, is_whole, length_of
from playground.shader.widgets import at_fraction, fraction_of
from playground.sketch.assign import range_of
from playground.sketch.model import Parameter, Value
from playground.studio.language import tr_label


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
    unit = "°" if unit == "degrees" else tr_label(unit)
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

_DECIMAL_COMMA = re.compile(r"[-+]?\d*,\d+")
"""A number as some languages write it; of a single one the comma is no mark between several."""
_WORDS = ("menu", "file", "checkbox", "button")


def read_typed(parameter: Parameter, text: str, path: str) -> Value:
    """Return the value that a text means; commas separate several numbers.

    A single number may have a decimal comma.
    Raises ``ParameterError`` for what is no expression, and for a value that the parameter
    does not take: one outside its range, which ``--set`` and the sketch refuse as well.
    """
    text = text.strip()
    if length_of(parameter.type) == 1 and _DECIMAL_COMMA.fullmatch(text):
        text = text.replace(",", ".")
    if parameter.widget.kind in _WORDS or text.startswith("#"):
        return coerce(parameter, text, path)
    try:
        numbers = evaluate_numbers(text, NAMES)
    except ExpressionError as error:
        raise ParameterError(f"{path}: {error}") from None
    whole = is_whole(parameter.type)
    result = [int(n) if whole and n.is_integer() else n for n in numbers]
    return coerce(parameter, result[0] if len(result) == 1 else result, path)


# ── fractions of a range ──────────────────────────────────────────────────────


HALF = 64 / 127
"""From which fraction on a checkbox is on, and a button pressed: 64 of MIDI's 127."""


def check_range(parameter: Parameter, path: str) -> None:
    """Raise ``ParameterError`` for a parameter that has no range."""
    kind = parameter.widget.kind
    if kind == "file":
        raise ParameterError(f"{path} names a file, so no knob can set it")
    if kind != "colour" and not is_switch(parameter) and range_of(parameter) is None:
        raise ParameterError(f"{path} has no range: no knob can set it without a slider(low, high)")


def is_switch(parameter: Parameter) -> bool:
    """Say whether a parameter has a few choices rather than a range: a knob takes it over at once."""
    return parameter.widget.facts.is_switch


def value_fraction(parameter: Parameter, value: Value, part: int = 0) -> float:
    """Return which fraction of its range a value, or a part of it, is at: 0 to 1."""
    widget = parameter.widget
    if parameter.type == "bool":
        return 1.0 if value else 0.0
    number = _numbers(value)[part]
    if widget.kind == "menu":
        return (number + 0.5) / max(len(widget.choices), 1)
    if _is_encoded(parameter, part):
        number = float(linear_to_srgb([min(max(number, 0.0), 1.0)])[0])
    low, high = _ends(parameter, part)
    if widget.kind == "direction" and part == 0:
        number = number if number == high else number % 360.0
    return min(max(fraction_of(number, low, high, log=widget.facts.is_log), 0.0), 1.0)


def with_fraction(parameter: Parameter, value: Value, fraction: float, part: int = 0) -> Value:
    """Return a value with one part, or all of a scalar, at a fraction of its range: 0 to 1."""
    widget, fraction = parameter.widget, min(max(fraction, 0.0), 1.0)
    if parameter.type == "bool":
        return fraction >= HALF
    if widget.kind == "menu":
        return min(int(fraction * len(widget.choices)), len(widget.choices) - 1)
    low, high = _ends(parameter, part)
    number = at_fraction(fraction, low, high, log=widget.facts.is_log)
    if _is_encoded(parameter, part):
        number = float(srgb_to_linear([number])[0])
    else:
        number = _stepped(parameter, number, low, high)
    numbers = list(_numbers(value))
    numbers[part] = number
    if is_whole(parameter.type):
        whole = tuple(round(n) for n in numbers)
        return whole if isinstance(value, tuple) else whole[0]
    return tuple(numbers) if isinstance(value, tuple) else numbers[0]


def _stepped(parameter: Parameter, number: float, low: float, high: float) -> float:
    if is_whole(parameter.type):
        number = round(number)
    if parameter.step:
        number = low + round((number - low) / parameter.step) * parameter.step
    if parameter.widget.facts.is_log:
        number = float(f"{number:.5g}")
    elif not is_whole(parameter.type):
        number = round(number, decimals(parameter) + 2)  # finer than 14 bits are, and short in a file
    return min(max(number, low), high)


def _ends(parameter: Parameter, part: int) -> tuple[float, float]:
    return range_of(parameter, part) or (0.0, 1.0)


def _is_encoded(parameter: Parameter, part: int) -> bool:
    """Say whether a number is the light of a channel, which the panel shows display-encoded."""
    return parameter.widget.kind == "colour" and part < 3 and not parameter.widget.raw


def _numbers(value: Value) -> tuple[float, ...]:
    if isinstance(value, tuple):
        return tuple(float(n) for n in value)
    return (float(value),)
