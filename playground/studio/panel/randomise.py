"""Random values, the same for the same seed: anywhere in their ranges, or near what they are.

Each parameter draws from a sequence of its own, by its path, so that one more parameter in
a sketch moves no other. What has no range, a file or a plain number, has nothing to be drawn
from: it stays, and is only moved a little, in proportion to itself.

They are for the parameters of the terrain's shape, unless more is wanted: sun, camera and exposure at random
give pictures in which nothing can be compared, and the sizes of a raw file at random give no terrain at all.
"""

from __future__ import annotations

import math
from collections.abc import Collection, Iterable, Mapping
from random import Random

from playground.shader.colours import srgb_to_linear
from playground.shader.parameter import is_whole, tidied
from playground.sketch.assign import range_of
from playground.sketch.model import Parameter, PassSpec, Sketch, Value, kernels_of
from playground.sketch.wiring import output_names
from playground.studio.edits.edits import Draft
from playground.studio.panel.parameter_list import Filter, Item, filtered, main_items
from playground.studio.panel.values import is_switch, snapped, value_fraction, with_fraction

Targets = list[tuple[str, Parameter]]


def targets(draft: Draft | None, filter_: Filter, *, everything: bool = False) -> tuple[Targets, str]:
    """Return the parameters that random values are for, by path, and a few words for them.

    What a search has found; else, with ``everything``, all that the passes show; else the main
    parameters of the passes that make the shape, or all that those show. In a sketch without
    such passes: its main parameters, or all that its passes show but the view's.
    """
    if draft is None:
        return [], ""
    sections = filtered(draft, filter_).values()
    items, words = [item for section in sections for item in section.items], "those found by the search"
    if not filter_:
        items, words = [item for item in items if item.exported], "all that the passes show"
        if not everything:
            items, words = _of_the_shape(draft.base, items, main_items(draft.base))
    return [(item.path, item.parameter) for item in items if item.path not in draft.edits.locked], words


def _of_the_shape(sketch: Sketch, items: list[Item], main: tuple[Item, ...]) -> tuple[list[Item], str]:
    others = [spec for spec in sketch.graph.passes if spec.name != "view"]
    shape = [spec for spec in others if "height" in output_names(spec.technique) and not _reads_file(spec)]
    for chosen, words in (
        (_within(main, shape), "the main ones of the shape"),
        (_within(items, shape), "those of the shape"),
        (_within(main, others), "the main ones"),
        (_within(items, others), "every pass but the view"),
    ):
        if chosen:
            return chosen, words
    return [], "there are none"


def _within(items: Iterable[Item], passes: Collection[PassSpec]) -> list[Item]:
    names = {spec.name for spec in passes}
    return [item for item in items if item.path.partition(".")[0] in names]


def _reads_file(spec: PassSpec) -> bool:
    """Say whether a pass reads a file: its terrain is not made, and its parameters say how it is stored."""
    return any(p.widget.kind == "file" for _, kernel in kernels_of(spec.technique) for p in kernel.parameters)


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
    kind, value = parameter.widget.kind, parameter.default
    if kind == "direction":
        return round(randoms.uniform(0, 360), 1), round(randoms.uniform(*HEIGHTS), 1)
    if kind == "colour":
        return _colour(parameter, [randoms.random() for _ in range(3)])
    if kind == "button" or not (is_switch(parameter) or range_of(parameter)):
        return None
    for part in range(len(value) if isinstance(value, tuple) else 1):
        value = with_fraction(parameter, value, randoms.random(), part)
    return value


def _near(parameter: Parameter, value: Value, randoms: Random, strength: float) -> Value | None:
    kind = parameter.widget.kind
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
        seen = [value_fraction(parameter, value, part) + randoms.gauss(0, strength) for part in range(3)]
        return _colour(parameter, seen, numbers[3:])
    if range_of(parameter) is None:
        scaled = [tidied(snapped(parameter, n * math.exp(randoms.gauss(0, strength)))) for n in numbers]
        if is_whole(parameter.type):
            low, high = (0, 2**32 - 1) if parameter.type.startswith("u") else (-(2**31), 2**31 - 1)
            scaled = [min(max(round(n), low), high) for n in scaled]
        return tuple(scaled) if isinstance(value, tuple) else scaled[0]
    for part in range(len(numbers)):
        fraction = value_fraction(parameter, value, part) + randoms.gauss(0, strength)
        value = with_fraction(parameter, value, fraction, part)
    return value


def _colour(parameter: Parameter, seen: list[float], alpha: list[float] | None = None) -> Value:
    """Return a colour of eight bits a channel, so that it can be written as it is; alpha stays."""
    steps = [round(min(max(c, 0.0), 1.0) * 255) / 255 for c in seen]
    assert isinstance(parameter.default, tuple)
    components = steps if parameter.widget.raw else srgb_to_linear(steps).tolist()
    return (*components, *(alpha or parameter.default[3:]))
