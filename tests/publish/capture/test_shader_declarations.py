"""Declarations of an exported text: what each names, renamed and with other calls, scope by scope."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.publish.shader_export.declarations import Declaration, declarations_of
from playground.shader.source import read_source

from ...cases import each


def of(text: str, is_macro: bool = False) -> Declaration:
    return Declaration(("f",), text, is_macro)


@each(
    ("text", "renamed"),
    [
        ("float f(float x) { return far * x; }", "float f(float x) { return FAR * x; }"),
        ("float f(float far) { return far; }", "float f(float far) { return far; }"),  # a parameter
        (
            "float f() { float far = far + 1.0; return far; }",
            "float f() { float far = FAR + 1.0; return far; }",
        ),
        ("float f() { { float far; } return far; }", "float f() { { float far; } return FAR; }"),
        ("float f(S s) { return s.far; }", "float f(S s) { return s.far; }"),  # a member
        ("struct S { float far; };", "struct S { float far; };"),
        ("float f() { return 2.0far; }", "float f() { return 2.0far; }"),  # letters of a number
        ("float f() { return 1.0; }  // far away", "float f() { return 1.0; }  // far away"),
        ("float f() { return far(far); }", "float f() { return FAR(FAR); }"),
        (
            "    far = x;  // far\n    vec2 k = v.far;",
            "    FAR = x;  // far\n    vec2 k = v.far;",
        ),  # statements
        ("#ifdef far\nfloat f = far;\n#endif", "#ifdef FAR\nfloat f = FAR;\n#endif"),
    ],
)
def test_what_stands_around_is_renamed(text: str, renamed: str) -> None:
    assert of(text).renamed({"far": "FAR"}).text == renamed


@each(
    ("text", "renamed"),
    [
        ("#define f(x) (x * far)  // far", "#define f(x) (x * FAR)  // far"),
        ("#define f(far) (x * far)", "#define f(far) (x * far)"),
        ("#define far near", "#define FAR near"),
        ("// far\n#define f v.far + \\\n    far", "// far\n#define f v.far + \\\n    FAR"),
    ],
)
def test_a_macro_is_renamed_but_its_parameters(text: str, renamed: str) -> None:
    assert of(text, is_macro=True).renamed({"far": "FAR"}).text == renamed


@each(
    ("text", "changed"),
    [
        ("float f() { return texelFetch(t, p, 0).r; }", "float f() { return <texelFetch>.r; }"),
        ("float f(sampler2D t) { return texelFetch(t, p, 0).r; }", ""),
        ("float f() { return texelFetch(u, p, 0).r; }", ""),
        ("float f() { return at(s, g(t)) + at(t, ivec2(at(t, p))); }",
         "float f() { return at(s, <g>) + <at>; }"),
        ("float f() {\n    return at(  // t\n        t, p);\n}", "float f() {\n    return <at>;\n}"),
    ],
)  # fmt: skip
def test_calls_that_take_a_texture_are_replaced(text: str, changed: str) -> None:
    assert of(text).with_calls("t", lambda name, before, behind: f"<{name}>").text == (changed or text)


def test_calls_in_arguments_and_macros_are_replaced_first() -> None:
    def either(name: str, before: str, behind: str) -> str:
        return f"({before}t{behind} : {before}u{behind})"

    text = of("vec4 f() { return at(t, at(t, p)); }").with_calls("t", either).text
    inner = "(at(t, p) : at(u, p))"
    assert text == f"vec4 f() {{ return (at(t, {inner}) : at(u, {inner})); }}"
    macro = of("#define f(p) at(t, p) + p.x", is_macro=True).with_calls("t", either)
    assert macro.text == "#define f(p) (at(t, p) : at(u, p)) + p.x"


TEXT = """// A header of the file.

uniform float gain = 1.0;  //! slider(0, 4) How much
// What light has.
struct Light { vec3 to; float gain; };
const float NEAR = 1.0,
    FAR = 2.0;  // [m]
#define TWICE(x) (2.0 * (x))

// anchor: sum
float sum(Light one) {

    // all of it
    return one.gain + gain;
}
// end: sum
float a; float b[2] = float[](NEAR, FAR);
"""


@pytest.fixture
def written(tmp_path: Path) -> Path:
    return tmp_path / "k.glsl"


def test_a_text_is_split_with_its_comments(written: Path) -> None:
    written.write_text(TEXT)
    declarations = declarations_of(read_source(written, ()).lines)
    assert [(each.names, each.text) for each in declarations] == [
        (("Light",), "// What light has.\nstruct Light { vec3 to; float gain; };"),
        (("NEAR", "FAR"), "const float NEAR = 1.0,\n    FAR = 2.0;  // [m]"),
        (("TWICE",), "#define TWICE(x) (2.0 * (x))"),
        (("sum",), "float sum(Light one) {\n    // all of it\n    return one.gain + gain;\n}"),
        (("a",), "float a;"),
        (("b",), "float b[2] = float[](NEAR, FAR);"),
    ]
    assert [each.is_macro for each in declarations] == [False, False, True, False, False, False]


def test_a_text_with_conditions_is_one_declaration(written: Path) -> None:
    written.write_text("// About.\n\nuniform float gain;\n#ifdef X\nfloat a;\n#else\nfloat b;\n#endif\n")
    (whole,) = declarations_of(read_source(written, ()).lines)
    assert set(whole.names) == {"a", "b"}
    assert whole.text == "#ifdef X\nfloat a;\n#else\nfloat b;\n#endif"
