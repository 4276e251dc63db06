"""The table of widgets: what it says is what the library's README and the page runtime have."""

from __future__ import annotations

import math
import re
from pathlib import Path

import pytest

import playground
from playground.paths import GLSL
from playground.shader.widgets import WIDGETS, at_fraction, fraction_of, usage

RUNTIME = Path(playground.__file__).parent / "web" / "runtime"


@pytest.mark.parametrize("name", [name for name in WIDGETS if name not in ("number", "file")])
def test_the_readme_has_a_row_for_each_widget(name):
    readme = (GLSL / "README.md").read_text(encoding="utf-8")
    assert f"| {usage(name)} | {WIDGETS[name].about} |" in readme.splitlines()


def test_pages_have_a_control_for_each_widget():
    text = (RUNTIME / "controls.js").read_text(encoding="utf-8")
    table = text[text.index("const KINDS") : text.index("\n};\n")]
    controls = set(re.findall(r"^  (\w+)[,:(]", table, re.MULTILINE))
    assert controls == {kind.control for kind in WIDGETS.values()} - {"numbers"}


@pytest.mark.parametrize("name", WIDGETS)
def test_ranges_suit_the_components(name):
    kind = WIDGETS[name]
    for ends in (*kind.spans, *kind.limits, *filter(None, [kind.range])):
        assert ends[0] < ends[1]
    for each in (kind.spans, kind.limits):
        assert len(each) in (0, len(kind.parts))


@pytest.mark.parametrize(("log", "middle"), [(False, 50.05), (True, math.sqrt(10.0))])
def test_a_fraction_of_a_range_is_the_inverse_of_its_number(log, middle):
    low, high = 0.1, 100.0
    assert at_fraction(0.5, low, high, log=log) == pytest.approx(middle)
    for number in (low, 0.7, 31.0, high):
        fraction = fraction_of(number, low, high, log=log)
        assert at_fraction(fraction, low, high, log=log) == pytest.approx(number)


def test_an_empty_range_and_what_lies_below_one_are_at_its_start():
    assert fraction_of(3.0, 3.0, 3.0, log=False) == 0.0
    assert fraction_of(-1.0, 0.1, 100.0, log=True) == 0.0
