"""Random values, the same for the same seed: anywhere in their ranges, or near what they are.

Each parameter draws from a sequence of its own, by its path, so that one more parameter in
a sketch moves no other. What has no range, a file or a plain number, has nothing to be drawn
from: it stays, and is only moved a little, in proportion to itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from random import Random

from playground.shader.colours import linear_to_srgb, srgb_to_linear
from playground.shader.parameter import is_whole, tidied
from playground.shader.widgets import at_fraction, fraction_of
from playground.sketch.model import Parameter, Value
from playground.studio.panel.number_format import snapped

HEIGHTS = (5.0, 85.0)
"""[degrees] above the horizon that a direction at random lies: at the ends there is little to see."""


def at_random(parameters: Iterable[tuple[str, Parameter]], seed: int) -> dict[str, Value]:
    """Return a value anywhere in its range for each parameter that has one, by path.

    Evenly over the slider's own way: a logarithmic one by its logarithm, a menu by its
    choices, a colour by what is visible.
    """
    values = {path: _anywhere(parameter, Random(f"{seed} {path}")) for path, parameter in parameters}
    return {path: value for path, value in values.items() if value is not None}


def mutated(
    parameters: Iterable[tuple[str, Parameter]], values: Mapping[str, Value], seed: int, strength: float
) -> dict[str, Value]:
    """Return a value near the one of now for each parameter, by path.

    ``strength`` (0..1) is the standard deviation of the way it goes, in fractions of its range,
    and the probability that a menu or a checkbox changes at all.
    """
    result = {
        path: _near(parameter, values[path], Random(f"{seed} {path}"), strength)
        for path, parameter in parameters
    }
    return {path: value for path, value in result.items() if value is not None}


def _anywhere(parameter: Parameter, randoms: Random) -> Value | None:
    kind, (low, high) = parameter.widget.kind, (parameter.widget.low, parameter.widget.high)
    if kind == "menu":
        return randoms.randrange(len(parameter.widget.choices))
    if kind == "checkbox":
        return randoms.random() < 0.5
    if kind == "button":
        return None
    if kind == "direction":
        return round(randoms.uniform(0, 360), 1), round(randoms.uniform(*HEIGHTS), 1)
    if kind == "colour":
        return _colour(parameter, [randoms.random() for _ in range(3)])
    if low is None or high is None:
        return None
    return _number(parameter, [_value_at(parameter, randoms.random(), n) for n in range(_count(parameter))])


def _near(parameter: Parameter, value: Value, randoms: Random, strength: float) -> Value | None:
    kind, (low, high) = parameter.widget.kind, (parameter.widget.low, parameter.widget.high)
    if kind in ("menu", "checkbox"):
        return _anywhere(parameter, randoms) if randoms.random() < strength else value
    if isinstance(value, str) or kind == "button":
        return None
    numbers = [float(n) for n in value] if isinstance(value, tuple) else [float(value)]
    if kind == "direction":
        azimuth = (numbers[0] + 360 * randoms.gauss(0, strength)) % 360
        elevation = numbers[1] + 90 * randoms.gauss(0, strength)
        return round(azimuth, 1), round(min(max(elevation, HEIGHTS[0]), HEIGHTS[1]), 1)
    if kind == "colour":
        held = [min(max(n, 0.0), 1.0) for n in numbers[:3]]
        seen = held if parameter.widget.raw else linear_to_srgb(held).tolist()
        return _colour(parameter, [c + randoms.gauss(0, strength) for c in seen], numbers[3:])
    if low is None or high is None:
        return _number(parameter, [n * math.exp(randoms.gauss(0, strength)) for n in numbers])
    shares = [_share(parameter, n, axis) + randoms.gauss(0, strength) for axis, n in enumerate(numbers)]
    return _number(parameter, [_value_at(parameter, share, axis) for axis, share in enumerate(shares)])


def _value_at(parameter: Parameter, share: float, axis: int) -> float:
    """Return the number at a fraction of the slider's way; ``axis`` is its place in a vector."""
    low, high = parameter.widget.ends(axis)
    assert low is not None and high is not None
    return at_fraction(min(max(share, 0.0), 1.0), low, high, log=parameter.widget.facts.is_log)


def _share(parameter: Parameter, number: float, axis: int) -> float:
    """Return the fraction of the slider's way at which a number lies; ``axis`` is its place in a vector."""
    low, high = parameter.widget.ends(axis)
    assert low is not None and high is not None
    return fraction_of(number, low, high, log=parameter.widget.facts.is_log)


def _count(parameter: Parameter) -> int:
    return len(parameter.default) if isinstance(parameter.default, tuple) else 1


def _number(parameter: Parameter, numbers: list[float]) -> Value:
    held = [snapped(parameter, n) for n in numbers]
    values: tuple[float, ...] | tuple[int, ...]
    if is_whole(parameter.type):
        lowest, highest = (0, 2**32 - 1) if parameter.type.startswith("u") else (-(2**31), 2**31 - 1)
        values = tuple(min(max(round(n), lowest), highest) for n in held)
    else:
        values = tuple(tidied(n) for n in held)
    return values if _count(parameter) > 1 else values[0]


def _colour(parameter: Parameter, seen: list[float], alpha: list[float] | None = None) -> Value:
    """Return a colour of eight bits a channel, so that it can be written as it is; alpha stays."""
    steps = [round(min(max(c, 0.0), 1.0) * 255) / 255 for c in seen]
    assert isinstance(parameter.default, tuple)
    components = steps if parameter.widget.raw else srgb_to_linear(steps).tolist()
    return (*components, *(alpha or parameter.default[3:]))
