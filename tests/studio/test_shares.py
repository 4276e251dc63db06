"""Shares of a widget's range: they come back, their ends are the range's, and steps are kept."""

from __future__ import annotations

import itertools

import pytest

from playground.errors import ParameterError
from playground.shader.parameter import coerce, part_names
from playground.shader.widgets import Widget
from playground.sketch.assign import range_of
from playground.sketch.model import Parameter, Value
from playground.studio.panel.values import check_range, value_fraction, with_fraction

SLIDER = Widget("slider", -2.0, 6.0)
ALL: list[tuple[Parameter, Value]] = [
    (Parameter("a", "float", 0.0, SLIDER), 1.0),
    (Parameter("a", "float", 0.0, SLIDER, step=0.5), 1.0),
    (Parameter("a", "float", 1.0, Widget("log_slider", 0.01, 100.0)), 1.0),
    (Parameter("a", "int", 0, Widget("slider", -3, 12)), 1),
    (Parameter("a", "uint", 0, Widget("slider", 0, 9999)), 1),
    (Parameter("a", "ivec2", (0, 0), Widget("slider", 0, 8)), (1, 2)),
    (Parameter("a", "vec3", (0.0,) * 3, SLIDER), (0.0, 1.0, 2.0)),
    (Parameter("a", "vec2", (0.0, 0.0), Widget("direction")), (135.0, 25.0)),
    (Parameter("a", "vec4", (0.0,) * 4, Widget("colour")), (0.5, 0.25, 0.125, 1.0)),
    (Parameter("a", "vec2", (0.0, 0.0), Widget("point", 0.0, 1.0)), (0.5, 0.5)),
    (Parameter("a", "vec2", (0.0, 2.0), Widget("point", axes=((-1.0, 1.0), (2.0, 9.0)))), (0.0, 3.0)),
    (Parameter("a", "vec3", (0.0,) * 3, Widget("colour", raw=True)), (0.5, 0.25, 0.125)),
    (Parameter("a", "float", 0.0, Widget("angle", -360.0, 360.0)), 0.0),
    (Parameter("a", "int", 0, Widget("menu", choices=("x", "y", "z"))), 1),
    (Parameter("a", "bool", False, Widget("checkbox")), False),
]


@pytest.mark.parametrize(("parameter", "value"), ALL, ids=lambda item: getattr(item, "type", ""))
def test_every_fraction_gives_valid_value_at_its_position(parameter: Parameter, value: Value):
    choices = len(parameter.widget.choices) or (2 if parameter.type == "bool" else 0)
    for part, step in itertools.product(range(len(part_names(parameter)) or 1), range(0, 128, 7)):
        share = step / 127
        made = with_fraction(parameter, value, share, part)
        assert coerce(parameter, made) == made
        assert type(made) is type(value) or parameter.type == "bool"
        back = value_fraction(parameter, made, part)
        ends = range_of(parameter, part) or (0.0, 1.0)
        whole = parameter.type.startswith(("i", "u"))
        grain = 1.0 if whole else parameter.step or 0.0
        allowed = 0.5 / choices + 1e-9 if choices else 0.5 * grain / (ends[1] - ends[0]) + 1e-4
        if parameter.type == "bool":
            allowed = 0.5
        assert abs(back - share) <= allowed, (share, made, back)
        if isinstance(value, tuple) and isinstance(made, tuple):
            assert [n for at, n in enumerate(made) if at != part] == [
                n for at, n in enumerate(value) if at != part
            ]


def test_the_ends_are_those_of_the_range():
    for parameter, value in ALL:
        if parameter.widget.kind in ("slider", "log_slider", "angle", "point"):
            low, high = range_of(parameter) or (0, 0)
            for share, end in ((0.0, low), (1.0, high), (-1.0, low), (2.0, high)):
                made = with_fraction(parameter, value, share)
                assert (made[0] if isinstance(made, tuple) else made) == end


def test_steps_are_counted_from_the_lower_end():
    parameter = Parameter("a", "float", 0.0, Widget("slider", 0.25, 1.25), step=0.5)
    assert {with_fraction(parameter, 0.25, n / 127) for n in range(128)} == {0.25, 0.75, 1.25}


def test_what_has_no_range_is_refused_in_a_sentence():
    check_range(ALL[0][0], "a")
    for parameter, why in (
        (Parameter("a", "float", 0.0), "no range"),
        (Parameter("a", "sampler2D", "", Widget("file")), "names a file"),
    ):
        with pytest.raises(ParameterError, match=why):
            check_range(parameter, "height.a")
