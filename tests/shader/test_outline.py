"""The outline of a GLSL file: its declarations with their comments, and the names in its functions."""

from __future__ import annotations

import sys
from types import FrameType

import pytest

from playground import memo
from playground.paths import GLSL
from playground.shader.driver_log import library
from playground.shader.outline import outline
from playground.shader.syntax import parser
from playground.sketch.load import load

TEXT = """// A file. float no(int comment);
#ifndef GUARD
#define GUARD
#define TWICE(x) ((x) * 2.0)

struct March {
    vec2 start;  // where
    float far;
};

// How steep it is.
// Not how high.
float steep(vec2 slope, const in March march) {
    float first = slope.x, second[2] = float[2](slope.y, 0.0);
    for (int step = 0; step < 3; step++) { vec2 far = vec2(float(step)); first += far.x; }
    return first + second[0] /* + hidden */ + march.far;
}
float asked(vec2 place);
const float LEAST = 1e-6;
uniform vec3 tint = vec3(1.0);  //! colour
#endif
"""


def test_each_declaration_has_kind_signature_and_comment() -> None:
    result = {item.name: item for item in outline(TEXT)}
    assert {name: item.kind for name, item in result.items()} == {
        "TWICE": "macro",
        "March": "struct",
        "steep": "function",
        "asked": "function",
        "LEAST": "variable",
        "tint": "uniform",
    }
    assert result["steep"].signature == "float steep(vec2 slope, const in March march)"
    assert result["steep"].comment == "How steep it is.\nNot how high."
    assert result["asked"].is_prototype and not result["steep"].is_prototype
    for item in result.values():
        assert TEXT[item.at :].startswith(item.name)
    assert TEXT[result["steep"].body] == "{" and TEXT[result["steep"].end - 1] == "}"


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("const int LOW = 0, HIGH = 1;", ["LOW", "HIGH"]),
        ("#define random random_at\nfloat random(ivec2 p) { return 1.0; }", ["random", "random"]),
        (
            "#define MAKE(name) float name(float x) { return x; }\nMAKE(first)\nMAKE(second)",
            ["MAKE", "first", "second"],
        ),
        (
            "#ifdef FINE\nfloat fine(float x) {\n#else\nfloat coarse() {\n#endif\nreturn 1.0; }",
            ["fine", "coarse"],
        ),
        (
            "#ifndef GUARD\n#define GUARD\n#ifndef SIDE\n#define SIDE 8\n#endif\nfloat a;\n#endif",
            ["SIDE", "a"],
        ),
        (
            "uniform Lights { vec3 sun, sky; };\nbuffer Heights { float all[]; } heights;",
            ["sun", "sky", "heights"],
        ),
        ("struct Wave { float far; } wave, other[2];", ["Wave", "wave", "other"]),
        ("float a(float x) { return x + ; }\nfloat b() { return 1.0; }\nuniform float c;", ["a", "b", "c"]),
    ],
)
def test_each_name_of_the_top_level_is_listed_as_it_is_written(text: str, names: list[str]) -> None:
    result = outline(text)
    assert [item.name for item in result] == names
    assert all(text.startswith(item.name, item.at) for item in result)


@pytest.mark.parametrize(
    "pragma",
    [
        '#pragma kernel(output = "height:r32f", \\\n    about = "https://example.org // it")',
        '#pragma kernel(output = "height:r32f") // see https://example.org \\\n  and what follows',
        '#pragma kernel(output = "height:r32f", \\\n    about = "never closed // it \\\n   and on)',
        '#pragma kernel(output = "a \\" // b", /* c // */ \\\n size = "1")',
    ],
)
def test_what_follows_a_pragma_with_slashes_is_declared(pragma: str) -> None:
    text = (
        pragma + "\nuniform float gain = 1.0;  //! slider(0, 1)\nfloat kernel(ivec2 texel) { return gain; }\n"
    )
    assert [item.name for item in outline(text)] == ["gain", "kernel"]


def test_a_bracket_that_is_never_closed_hides_no_other_function() -> None:
    text = "float a(float x) {\n    if (x > 0.0) {\n    return x;\n}\nfloat b() { return 1.0; }\n"
    assert [item.name for item in outline(text)] == ["a", "b"]


def test_every_library_function_is_in_outline_of_its_file() -> None:
    """``library`` finds them by another way, by lines that begin like one."""
    missing = [
        name
        for name, files in library().items()
        for file in files
        if name not in {item.name for item in outline((GLSL / file).read_text(encoding="utf-8"))}
    ]
    assert missing == []


@pytest.mark.parametrize("name", ["l_dot_n", pytest.param("october", marks=pytest.mark.slow)])
def test_a_sketch_is_loaded_without_a_syntax_tree(name: str) -> None:
    """A large one has tens of thousands of flattened lines, which would take seconds to parse."""
    memo.clear()
    parsed: set[str] = set()

    def note(frame: FrameType, event: str, _: object) -> None:
        if event == "call" and frame.f_code.co_filename == parser.__file__:
            parsed.add(frame.f_code.co_name)

    sys.setprofile(note)
    try:
        sketch = load(name)
    finally:
        sys.setprofile(None)
    assert sketch.graph.kernels
    assert not parsed


def test_the_reference_explains_every_key() -> None:
    from playground.sketch import toml_table

    page = (GLSL.parent / "docs" / "reference" / "sketch-file.md").read_text(encoding="utf-8")
    for table in (toml_table.SKETCH, *toml_table.TABLES.values()):
        for key in table:
            assert f"`{key}`" in page or f"[{key}]" in page, key
