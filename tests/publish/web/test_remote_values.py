"""Values of a window's parameters between its JSON and the rows of its remote's page."""

from __future__ import annotations

import pytest

from playground.shader.colours import parse_hex

from .node import Node

MENU = {"widget": "menu", "choices": ["round", "sharp", "flat"]}


def test_a_menu_has_a_name_in_json_and_a_number_in_its_row(node: Node):
    for number, name in enumerate(MENU["choices"]):
        assert node.call("numbers.js", "shownValue", MENU, name) == number
        assert node.call("numbers.js", "toldValue", MENU, number) == name
    assert node.call("numbers.js", "shownValue", MENU, "unheard") == -1  # not the first


@pytest.mark.parametrize("raw", [False, True])
@pytest.mark.parametrize("text", ["#ff8000", "#000000", "#12345678"])
def test_a_colour_is_linear_light_in_its_row_as_in_python(node: Node, text: str, raw: bool):
    item = {"widget": "colour", "choices": [], "raw": raw}
    result = node.call("numbers.js", "shownValue", item, text)
    assert result == pytest.approx(parse_hex(text, raw=raw), abs=1e-12)
    assert node.call("numbers.js", "shownValue", item, [0.25, 0.5, 2.0]) == [0.25, 0.5, 2.0]
    assert node.call("numbers.js", "toldValue", item, [0.25, 0.5, 2.0]) == [0.25, 0.5, 2.0]


def test_other_values_are_the_same_in_both(node: Node):
    for widget, value in (("slider", 0.25), ("direction", [135.0, 25.0]), ("checkbox", True), ("file", "a")):
        item = {"widget": widget, "choices": []}
        assert node.call("numbers.js", "shownValue", item, value) == value
        assert node.call("numbers.js", "toldValue", item, value) == value
