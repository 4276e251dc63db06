"""A function that has not the form its header asks for is refused in the words and at the line of Python."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import pytest

from playground.errors import ShaderError
from playground.publish.web.formulas import formula
from playground.shader.header import parse_kernel
from playground.shader.source import read_source
from playground.shader.wrap import FRAGMENT, wrap
from playground.sketch.model import Kernel

from .node import Node, NodeError
from .texts import kernels

ONE = '#pragma kernel(output = "h:r32f"{})\n'
TWO = '#pragma kernel(output = "a:rg32f, b:rgba8"{})\n'
REPEATS = ', repeat = "2"'
DRAW = '#pragma draw(mesh = "sheet", output = "c:rgba8")\n'
TEXTS = [
    ONE.format("") + "float kernel(ivec2 texel) { return 1.0; }",
    ONE.format("") + "float\n  kernel\n(const in highp ivec2 t)\n{ return 1.0; }",
    ONE.format("") + "float kernels(ivec2 texel) { return 1.0; }",
    ONE.format("") + "int a;\nvec4 kernel(ivec2 texel) { return vec4(1.0); }",
    ONE.format("") + "float kernel(ivec2 texel, out float h) { return 1.0; }",
    ONE.format("") + "float kernel(vec2 texel) { return 1.0; }",
    ONE.format("") + "float kernel() { return 1.0; }",
    ONE.format("") + "float kernel(inout ivec2 t) { return 1.0; }",
    ONE.format("") + "float kernel(ivec2 a b c) { return 1.0; }",
    ONE.format("") + "float kernel(ivec2 t);",
    ONE.format("") + "int a;\n\nfloat kernel(ivec2 t) { return previous (t); }",
    ONE.format(REPEATS) + "float kernel(ivec2 t) { return previous(t); }",
    ONE.format(REPEATS) + "float kernel(ivec2 t) {\n return previous_h(t); }",
    ONE.format(REPEATS) + "float previous_x(ivec2 t) { return 1.0; } float kernel(ivec2 t) { return 1.0; }",
    TWO.format("") + "void kernel(ivec2 t, out vec2 a, out vec4 b) { a = vec2(0); b = vec4(0); }",
    TWO.format("") + "void kernel(ivec2 t, out vec4 a, out vec2 b) { }",
    TWO.format("") + "\nvoid kernel(ivec2 t, out vec2 b, out vec4 a) { }",
    TWO.format("") + "vec4 kernel(ivec2 t) { }",
    TWO.format(REPEATS)
    + "void kernel(ivec2 t, out vec2 a, out vec4 b) { a = previous_a(t); b = previous(t); }",
    DRAW + "vec4 vertex(vec3 c, out vec3 p) { return vec4(0); }\nvec4 fragment(vec3 p) { return vec4(0); }",
    DRAW + "vec4 vertices(vec3 c, out vec3 p) { return vec4(0); }\nvec4 fragment(vec3 p) { return vec4(0); }",
    DRAW + "vec4 vertex(vec3 c, out vec3 p) { return vec4(0); }\nvec3 fragment(vec3 p) { return vec3(0); }",
]
SCRIPT = """async (kernel, text, load) => {
  const { flatten } = await load("source.js"), { checkSignature } = await load("edits.js");
  checkSignature(kernel, flatten({ files: { "./a.glsl": text }, includes: {} }, "./a.glsl"));
}"""


def given(kernel: Kernel) -> dict[str, Any]:
    outputs = [{"name": output.name, "format": output.format} for output in kernel.outputs]
    return {"kind": kernel.kind, "outputs": outputs, "repeat": formula(kernel.repeat)}


def refusal(kernel: Kernel) -> tuple[str, int] | None:
    """Return the message and the line with which Python refuses a kernel's text."""
    try:
        wrap(kernel, FRAGMENT)
    except ShaderError as error:
        return error.diagnostics[0].message, error.diagnostics[0].line
    return None


def test_texts_are_refused_where_python_refuses_them(node: Node, tmp_path: Path):
    refused = 0
    for number, text in enumerate(TEXTS):
        path = tmp_path / f"{number}.glsl"
        path.write_text(f"// a\n{text}\n")
        kernel = parse_kernel(path.name, read_source(path, []))
        assert kernel
        try:
            node.run(SCRIPT, given(kernel), path.read_text())
            result = None
        except NodeError as error:
            assert error.details["file"] == "./a.glsl"
            result = error.message, error.details["line"]
        assert result == refusal(kernel), text
        refused += result is not None
    assert refused > 12 and len(TEXTS) - refused > 4


@pytest.mark.slow
def test_no_program_of_the_library_is_refused(node: Node):
    for kernel in kernels().values():
        lines = [{"code": line.code, "raw": line.text, "file": "", "line": 1} for line in kernel.source.lines]
        node.call("edits.js", "checkSignature", given(kernel), {"lines": lines})
