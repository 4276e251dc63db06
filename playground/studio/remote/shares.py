"""Map a fraction of a widget's range, from 0 to 1, to a value and back: what a knob or a fader says.

Linear over the range, logarithmic where its scale is, in equal stretches for a menu, from the
half on for a checkbox. A colour's channels are display-encoded, as the panel shows them. A
vector has one share for each part.
"""

from __future__ import annotations

from playground.errors import ParameterError
from playground.shader.colours import linear_to_srgb, srgb_to_linear
from playground.shader.parameter import is_whole
from playground.shader.widgets import at_fraction, fraction_of
from playground.sketch.assign import range_of
from playground.sketch.model import Parameter, Value
from playground.studio.panel.number_format import decimals

HALF = 64 / 127
"""From which share on a checkbox is on, and a button pressed: 64 of MIDI's 127."""


def check_shares(parameter: Parameter, path: str) -> None:
    """Raise ``ParameterError`` for a parameter that has no range to share out."""
    kind = parameter.widget.kind
    if kind == "file":
        raise ParameterError(f"{path} names a file, so no knob can set it")
    if kind != "colour" and not is_switch(parameter) and range_of(parameter) is None:
        raise ParameterError(f"{path} has no range: no knob can set it without a slider(low, high)")


def is_switch(parameter: Parameter) -> bool:
    """Say whether a parameter has a few choices rather than a range: a knob takes it over at once."""
    return parameter.widget.facts.is_switch


def share_of(parameter: Parameter, value: Value, part: int = 0) -> float:
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


def with_share(parameter: Parameter, value: Value, share: float, part: int = 0) -> Value:
    """Return a value with one part, or all of a scalar, at a fraction of its range: 0 to 1."""
    widget, share = parameter.widget, min(max(share, 0.0), 1.0)
    if parameter.type == "bool":
        return share >= HALF
    if widget.kind == "menu":
        return min(int(share * len(widget.choices)), len(widget.choices) - 1)
    low, high = _ends(parameter, part)
    number = at_fraction(share, low, high, log=widget.facts.is_log)
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
