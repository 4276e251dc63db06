"""Macro calls that span lines are joined on their first; every other line stays where it is."""

from __future__ import annotations

import pytest

from playground.shader.source import with_calls_joined

SUM = "#define SUM(a, b) ((a) + (b))"


@pytest.mark.parametrize(
    ("lines", "joined"),
    [
        (["x = SUM(1,", "        2);", "y"], ["x = SUM(1, 2);", "", "y"]),
        (["x = SUM(1,", "", "  f(2),", "  );", "y"], ["x = SUM(1, f(2), );", "", "", "", "y"]),
        (["x = SUM", "  (1, 2);", "y"], ["x = SUM (1, 2);", "", "y"]),
        (
            ["x = SUM(1, 2) + SUM(", "3, SUM(4,", "5));", "y"],
            ["x = SUM(1, 2) + SUM( 3, SUM(4, 5));", "", "", "y"],
        ),
        (["x = SUM(1,", "2) + SUM(3,", "4);"], ["x = SUM(1, 2) + SUM(3, 4);", "", ""]),
        (["x = f(SUM(1, 2),", "3);"], ["x = f(SUM(1, 2),", "3);"]),
        (["x = SUMMER(1,", "2);"], ["x = SUMMER(1,", "2);"]),
        (["int SUM", "= 3;"], ["int SUM", "= 3;"]),
        (["x = SUM(1,", "never closed", "y"], ["x = SUM(1,", "never closed", "y"]),
        (["x = SUM(1,", "#ifdef A", "2);"], ["x = SUM(1,", "#ifdef A", "2);"]),
        (["x = SUM(1,", "2) + SUM(3", "never"], ["x = SUM(1,", "2) + SUM(3", "never"]),
    ],
)
def test_calls(lines, joined):
    assert with_calls_joined([SUM, *lines]) == [SUM, *joined]


def test_macro_alias_call_is_joined_and_plain_constant_is_not():
    text = [SUM, "#define ADD SUM", "#define PI 3.14", "ADD(1,", "2)", "PI * (1,", "2)"]
    assert with_calls_joined(text)[3:] == ["ADD(1, 2)", "", "PI * (1,", "2)"]


def test_before_its_definition_a_name_is_no_macro():
    assert with_calls_joined(["SUM(1,", "2)", SUM]) == ["SUM(1,", "2)", SUM]
