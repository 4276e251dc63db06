"""Uniforms that a text declares have the initial values that Python reads."""

from __future__ import annotations

import pytest

from playground.shader.parameter import length_of
from playground.sketch.model import Parameter

from ...cases import each
from .node import Node, NodeError
from .texts import kernels


def declared(node: Node, *codes: str) -> dict[str, object]:
    lines = [{"code": code, "file": "./a.glsl", "line": i} for i, code in enumerate(codes, 1)]
    return {each["name"]: each["value"] for each in node.call("source.js", "declaredUniforms", lines)}


def initial_of(parameter: Parameter) -> object:
    """Return what a parameter's uniform has at first."""
    value = parameter.default
    if parameter.widget.values:
        assert isinstance(value, int)
        return parameter.widget.values[value]
    return list(value) if isinstance(value, tuple) else value


@pytest.mark.slow
def test_every_parameter_of_the_library(node: Node):
    compared = 0
    for kernel in kernels().values():
        result = declared(node, *(line.code for line in kernel.source.lines))
        assert result.keys() == {*(p.name for p in kernel.parameters), *(i.name for i in kernel.inputs)}
        for parameter in kernel.parameters:
            if parameter.type != "sampler2D":
                assert result[parameter.name] == initial_of(parameter), (kernel.name, parameter.name)
                compared += 1
            else:
                assert result[parameter.name] is None
    assert compared > 500


@each(
    ("code", "value"),
    [
        ("uniform float a = -.5e1;", -5.0),
        ("  uniform highp float a=1.f;", 1.0),
        ("uniform float a = 2;", 2),
        ("uniform int a = 0x1F;", 31),
        ("uniform int a = -017;", -15),
        ("uniform int a = -0;", 0),
        ("uniform uint a = 7u;", 7),
        ("uniform bool a = true;", True),
        ("uniform bool a;", False),
        ("uniform vec3 a = vec3(1.5);", [1.5, 1.5, 1.5]),
        ("uniform ivec2 a = ivec2( 1.7 , -1.7 );", [1, -1]),
        ("uniform vec2 a;", [0, 0]),
        ("layout(location = 1) uniform vec2 a = vec2(1, 2);", [1, 2]),
        ("uniform mat3 a;", None),
        ("uniform float a[3];", None),
        ("uniform sampler2D a;", None),
    ],
)
def test_a_literal(node: Node, code: str, value: object):
    result = declared(node, code)["a"]
    assert result == value and type(result) in (type(value), int, float)


@each(
    "code",
    [
        "uniform float a = 1.0 * 2.0;",
        "uniform float a = b;",
        "uniform int a = 1.0;",
        "uniform int a = 089;",
        "uniform bool a = 1;",
        "uniform vec2 a = vec3(1);",
        "uniform vec3 a = vec3(1, 2);",
        "uniform vec2 a = vec2(1, b);",
        f"uniform float a = {'9' * 400}.0;",
    ],
)
def test_initial_value_of_wrong_type_is_refused_at_its_line(node: Node, code: str):
    with pytest.raises(NodeError, match="the initialiser of 'a' must be a literal") as caught:
        declared(node, "", code)
    assert caught.value.details == {"file": "./a.glsl", "line": 2}


def test_a_file_that_is_there_twice_declares_once(node: Node):
    assert declared(node, "uniform int a = 1;", "uniform int a = 1;") == {"a": 1}


def test_lengths_are_those_of_the_types(node: Node):
    for kind in ("vec2", "vec3", "vec4", "ivec2", "ivec3", "ivec4", "uvec2"):
        value = declared(node, f"uniform {kind} a;")["a"]
        assert isinstance(value, list) and len(value) == length_of(kind)
