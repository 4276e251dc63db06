"""Desktop GLSL as GLSL ES 3.00: every program of the library compiles, and no line of any text moves."""

from __future__ import annotations

from pathlib import Path

import moderngl
import pytest

from playground.shader.wrap import wrap
from playground.sketch.find import shipped_sketches
from playground.sketch.flat import leaves_of
from playground.sketch.flatten import flatten
from playground.sketch.model import ForeignShader, Kernel, PlainFragment

from ...cases import each
from ...loading import load
from .node import Node, NodeError
from .texts import kernels

pytestmark = pytest.mark.slow


PRECISION = "precision highp float; precision highp int;"

VERTEX = "#version 300 es\nvoid main() { gl_Position = vec4(0.0); }\n"


def stages_of(kernel: Kernel) -> list[str]:
    return [wrap(kernel, "fragment").stages[name].text for name in ("vertex", "fragment")]


def es(node: Node, text: str, **options: object) -> str:
    result = node.call("kernel_texts.js", "toES", text, options)
    assert isinstance(result, str)
    assert result.count("\n") == text.count("\n"), "a line moved"
    return result


def test_every_program_of_the_library_compiles_as_es(node: Node, ctx: moderngl.Context):
    if "GL_ARB_ES3_compatibility" not in ctx.extensions:
        pytest.skip("this driver compiles no GLSL ES")
    texts = [text for kernel in kernels().values() for text in stages_of(kernel)]
    result = node.each("kernel_texts.js", "toES", [[text] for text in texts])
    for name, vertex, fragment in zip(kernels(), result[::2], result[1::2], strict=True):
        try:
            ctx.program(vertex_shader=vertex, fragment_shader=fragment).release()
        except moderngl.Error as error:
            raise AssertionError(name) from error


def test_every_program_of_another_tool_that_ships_compiles_as_es(node: Node, ctx: moderngl.Context):
    if "GL_ARB_ES3_compatibility" not in ctx.extensions:
        pytest.skip("this driver compiles no GLSL ES")
    leaves = [leaf for name in shipped_sketches() for leaf in leaves_of(flatten(load(name)).nodes)]
    result = {leaf.kernel.name: leaf.kernel for leaf in leaves if isinstance(leaf.kernel, PlainFragment)}
    assert {k.dialect for k in result.values() if isinstance(k, ForeignShader)} >= {
        "main",
        "shadertoy",
        "isf",
    }
    for kernel in result.values():
        vertex, fragment = (es(node, text) for text in stages_of(kernel))
        ctx.program(vertex_shader=vertex, fragment_shader=fragment).release()


def test_what_packs_numbers_compiles_as_es(node: Node, ctx: moderngl.Context, tmp_path: Path):
    if "GL_ARB_ES3_compatibility" not in ctx.extensions:
        pytest.skip("this driver compiles no GLSL ES")
    calls = [f"vec4(unpack{kind}2x16(pack{kind}2x16(p)), 0.0, 1.0)" for kind in ("Half", "Snorm", "Unorm")]
    path = tmp_path / "a.frag"
    path.write_text(f"void mainImage(out vec4 c, in vec2 p) {{ c = {' + '.join(calls)}; }}\n")
    (leaf,) = [
        leaf for leaf in leaves_of(flatten(load(path)).nodes) if isinstance(leaf.kernel, ForeignShader)
    ]
    vertex, fragment = (es(node, text) for text in stages_of(leaf.kernel))
    ctx.program(vertex_shader=vertex, fragment_shader=fragment).release()


def test_es_lines_differ_in_version_precision_and_initial_value(node: Node):
    texts = [text for kernel in kernels().values() for text in stages_of(kernel)]
    initialised = 0
    for text, result in zip(
        texts, node.each("kernel_texts.js", "toES", [[text] for text in texts]), strict=True
    ):
        before, after = text.split("\n"), result.split("\n")
        assert len(before) == len(after)
        assert (before[0], after[0]) == ("#version 330", "#version 300 es")
        declared = next(i for i, line in enumerate(after) if line.startswith(PRECISION))
        assert after[declared].endswith(before[declared].partition(" = ")[0])
        assert all(not line.strip() or line.startswith("#") for line in before[1:declared])
        changed = [i for i in range(1, len(before)) if before[i] != after[i] and i != declared]
        for i in changed:
            name, equals, value = before[i].partition("=")
            assert name.lstrip().startswith("uniform ") and equals and value.rstrip().endswith(";")
            assert after[i] == f"{name};"
        initialised += len(changed)
    assert initialised > 500


@each(
    ("before", "after"),
    [
        ("uniform float a = 1.0;", "uniform float a ;"),
        ("uniform float a=1., b, c =2.;", "uniform float a, b, c ;"),
        ("uniform vec2 a = vec2(1, 2), b = vec2(f(1, 2), 3);", "uniform vec2 a , b ;"),
        ("uniform float a[2] = float[](1., 2.); int x = 1;", "uniform float a[2] ; int x = 1;"),
        ("uniform float a[2] = {1., 2.};", "uniform float a[2] ;"),
        ("uniform float a\n  =\n 1.0\n;", "uniform float a\n  \n\n;"),
        ("uniform Block { float a; }; int x = 1;", "uniform Block { float a; }; int x = 1;"),
        ("uniform float a; int x = 1;", "uniform float a; int x = 1;"),
        ("// uniform float a = 1.0;", "// uniform float a = 1.0;"),
        ("/* uniform\n float a = 1.0; */ int x;", "/* uniform\n float a = 1.0; */ int x;"),
        ("int uniforms = 1; int a_uniform = 2;", "int uniforms = 1; int a_uniform = 2;"),
        ("layout(location = 3) uniform float a = 1.0;", "layout(location = 3) uniform float a ;"),
    ],
)
def test_initial_values_go_and_line_ends_stay(node: Node, before: str, after: str):
    text = es(node, f"#version 330\n{before}\n")
    assert text == f"#version 300 es\n{PRECISION} {after}\n"


def test_a_macro_that_declares_uniforms_is_left_to_the_driver(node: Node):
    text = "#version 330\n#define U(n) uniform float n = 1.0;\nint x;\n"
    assert es(node, text) == text.replace("330", "300 es").replace("int x", f"{PRECISION} int x")


@each(
    ("before", "after"),
    [
        ("\nint x;", "{}\nint x;"),
        ("#define X\n\nint x;", "#define X\n{}\nint x;"),
        ("#if A\nint x;\nint y;\n#endif\nint z;\n", "#if A\n{} int x;\nint y;\n#endif\n{} int z;\n"),
        (
            "#if A\nint x;\n#else\n\nint x;\n#endif\nint y;\n",
            "#if A\n{} int x;\n#else\n{}\nint x;\n#endif\n{} int y;\n",
        ),
        (
            "#if A\n#if B\nint x;\n#endif\nfloat w;\n#elif B\nint x;\n#endif\n\nint y;\n",
            "#if A\n#if B\n{} int x;\n#endif\n{} float w;\n#elif B\n{} int x;\n#endif\n{}\nint y;\n",
        ),
    ],
)
def test_precisions_are_before_the_first_code_of_whatever_branch(
    node: Node, ctx: moderngl.Context, before: str, after: str
):
    main = "out vec4 c; float f() { return 1.0; } void main() { c = vec4(f()); }\n"
    text = es(node, f"#version 330\n{before}\n{main}")
    assert text == f"#version 300 es\n{after.replace('{}', PRECISION)}\n{main}"
    if "GL_ARB_ES3_compatibility" not in ctx.extensions:
        return
    for defined in ("#define A 0\n#define B 0\n", "#define A 1\n#define B 0\n", "#define A 0\n#define B 1\n"):
        chosen = text.replace("300 es\n", f"300 es\n{defined}")  # refused where a float has no precision
        ctx.program(vertex_shader=VERTEX, fragment_shader=chosen).release()


def test_samplers_get_the_precision_that_es_does_not_give_them(node: Node):
    kinds = ("sampler2D", "usampler3D", "sampler2D", "samplerCube")
    text = "#version 330\n" + "".join(
        f"uniform {kind} {name}; " for kind, name in zip(kinds, "abcd", strict=True)
    )
    precisions = es(node, text).split("\n")[1].partition(" uniform")[0]
    expected = ["float", "int", "sampler2D", "usampler3D", "samplerCube"]
    assert precisions == " ".join(f"precision highp {kind};" for kind in expected)


def test_a_version_below_comments_comes_first(node: Node):
    assert (
        es(node, "//\n//\n  # version 330 core\nint x;\n") == f"#version 300 es\n{PRECISION} //\n\nint x;\n"
    )


def test_code_above_the_version_is_refused(node: Node):
    with pytest.raises(NodeError, match="first line"):
        es(node, "int x;\n#version 330\n")


def test_extensions_go_unless_they_are_asked_for(node: Node):
    text = "#version 330\n#extension GL_ARB_x : enable\n#extension GL_EXT_y : require\nint x;\n"
    assert es(node, text).split("\n")[1:3] == [PRECISION, ""]
    result = es(node, text, extensions=["GL_EXT_y"])
    assert result.split("\n")[1:] == [PRECISION, "#extension GL_EXT_y : require", "int x;", ""]


def test_declarations_that_are_handed_in_come_first(node: Node):
    text = "#version 330\n#define A\n\nint a = f(1);\n"
    result = es(node, text, declarations="int f(int x) { return x; }")
    assert result == text.replace("330", "300 es").replace(
        "A\n", f"A\n{PRECISION} int f(int x) {{ return x; }}", 1
    )
