"""What a page reads of the parameters of an edited text is what Python reads."""

from __future__ import annotations

from typing import Any

import pytest

from playground.publish.web.parameter_data import row
from playground.sketch.assign import Shown

from ...cases import each
from .node import Node, NodeError
from .texts import kernels

FILE = "./a.glsl"


def written(node: Node, *raw: str) -> list[dict[str, Any]]:
    lines = [
        {"code": text.partition("//")[0].rstrip(), "raw": text, "file": FILE, "line": number}
        for number, text in enumerate(raw, 1)
    ]
    values = node.call("written_parameters.js", "writtenParameters", lines, FILE)
    assert isinstance(values, list)
    return values


@pytest.mark.slow
def test_every_parameter_of_the_library(node: Node):
    compared = 0
    for kernel in kernels().values():
        own = [line for line in kernel.source.lines if line.file == str(kernel.path)]
        result = {each["uniform"]["name"]: each for each in written(node, *(line.text for line in own))}
        here = {line.number: line for line in own}
        for parameter in kernel.parameters:
            if parameter.type == "sampler2D" or parameter.file != str(kernel.path):
                continue
            assert parameter.line in here
            item = result.pop(parameter.name)
            value = list(parameter.default) if isinstance(parameter.default, tuple) else parameter.default
            expected = row(Shown(f"a.{parameter.name}", parameter, exported=True), value, ())
            for key, fact in item["facts"].items():
                assert fact == expected[key], (kernel.name, parameter.name, key)
            assert item["uniform"].get("values", []) == list(parameter.widget.values)
            compared += 1
        assert not result, kernel.name
    assert compared > 300


@each(
    ("line", "message"),
    [
        ("uniform float a = 0.5;  //! slidr(0, 1)", "no widget 'slidr'; did you mean 'slider'?"),
        ("uniform float a = 0.5;  //! slider(1, 0)", "slider of 'a': expected two numbers, the lower first"),
        ("uniform float a = 0.5;  //! slider(0, 1", "'slider(' is not closed"),
        ("uniform float a = 0.5;  //! slider(0, 1) step(0)", "step of 'a': expected a number above 0"),
        ("uniform float a = 2.0;  //! slider(0, 1)", "the default of 'a' is 2, which it may not be"),
        ("uniform float a = 0.5;  //! checkbox", "checkbox does not suit 'a', a float"),
        ('uniform int a = 0;  //! menu("one")', "the menu of 'a' needs its choices"),
    ],
)
def test_what_cannot_be_read_is_said_at_its_line(node: Node, line: str, message: str):
    with pytest.raises(NodeError) as result:
        written(node, "// above", line)
    assert message in result.value.message and result.value.details["line"] == 2


def test_annotation_spans_lines_and_bare_uniform_is_number(node: Node):
    first, second = written(
        node,
        'uniform float a = 0.5;  //! slider(0, 1) label("Share")',
        "                        //! of all heights",
        "uniform int b = 3;",
    )
    assert (first["facts"]["label"], first["facts"]["description"]) == ("Share", "of all heights")
    assert (second["facts"]["widget"], second["facts"]["ranges"]) == ("number", [[None, None]])
