"""GLSL taken apart and put together: what is printed means the same, and every edit makes it simpler."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.paths import GLSL
from playground.sketch.techniques import read_kernel
from playground.verify.reduce import edits
from playground.verify.reduce.case import unwired, written_out
from playground.verify.reduce.edits import print_tokens, tidy, tokens_of
from playground.verify.reduce.search import blocks_of, fewer_lines, text_of_blocks

from ...cases import each

TEXT = """#pragma kernel(output = "height:r32f", repeat = "8")
uniform float gain = 1.0;  //! slider(0, 4) step(0.5) How high
uniform sampler2D terrain;    //! input "linear"
const int count = 3;
struct Sun { vec3 to; float size; };
float twice(float x, float unused) { return 2.0 * x; }   // a comment
float kernel(ivec2 texel) {
    float h = -gain;
    for (int i = 0; i < count; i++) h += twice(max(h, 1.5), 0.5);
    if (h > 2.0) { h = h > 3.0 ? sqrt(h) : 1.0 - h; } else { h -= 1.0; }
    return h + texelFetch(terrain, texel, 0).r;
}
"""


@pytest.mark.slow
@each("path", sorted(GLSL.rglob("*.glsl")), ids=lambda p: p.stem)
def test_tidying_changes_no_token_and_is_done_once(path: Path):
    text = path.read_text(encoding="utf-8").replace("\\\n", "")
    tokens = tokens_of(text)
    assert tokens_of(print_tokens(tokens)) == tokens
    assert tidy(tidy(text)) == tidy(text)


def test_an_annotation_of_several_lines_is_written_on_one(tmp_path: Path):
    (tmp_path / "gain.glsl").write_text("uniform float gain;  //! slider(0, 4)\n    //! How high\n")
    text = '#include "gain.glsl"\n#pragma kernel(output = "height:r32f")\n'
    (tmp_path / "k.glsl").write_text(text + "float kernel(ivec2 texel) { return gain; }\n")
    kernel = read_kernel(tmp_path / "k.glsl", tmp_path)
    assert kernel is not None
    assert "uniform float gain;  //! slider(0, 4) How high" in written_out(kernel).splitlines()


def test_a_statement_is_a_line():
    lines = tidy(TEXT).splitlines()
    assert "    for (int i = 0; i < count; i++) h += twice(max(h, 1.5), 0.5);" in lines
    assert "    float h = -gain;" in lines
    assert "        h = h > 3.0 ? sqrt(h) : 1.0 - h;" in lines
    assert not any("comment" in line for line in lines)
    assert "struct Sun {" in lines
    assert "};" in lines


def test_blocks_are_read_and_written_whole():
    text = tidy(TEXT)
    assert text_of_blocks(blocks_of(text)) == text
    function = next(n for n in blocks_of(text) if "kernel" in n.head and n.body is not None)
    assert [node.head.split()[0] for node in function.body] == ["float", "for", "if", "else", "return"]


def test_lines_go_until_none_can():
    """What must stay is named; all else goes, a block's braces with what they hold or without."""
    expected = ["float kernel(ivec2 texel) {", "h -= 1.0;", "return h"]
    text = fewer_lines(tidy(TEXT), lambda some: all(word in some for word in expected))
    assert text.split("\n") == [
        "float kernel(ivec2 texel) {",
        "        h -= 1.0;",  # no longer in its else; tidy moves it back
        "    return h + texelFetch(terrain, texel, 0).r;",
        "}",
        "",
    ]


def every_edit(text: str) -> list[str]:
    values = {"gain": "2.5"}
    return [
        *edits.expressions(text),
        *edits.headers(text),
        *edits.parameters_of_functions(text),
        *edits.inlined(text),
        *edits.constants(text, values),
    ]


@pytest.mark.parametrize(
    "expected",
    [
        "return x;",  # 2.0 * x, one side
        "twice(float x)",  # a parameter gone …
        "h += twice(max(h, 1.5));",  # … and its argument in the same edit
        "h += max(h, 1.5);",  # a call for its argument
        "h += twice(h, 0.5);",
        "h = sqrt(h);",  # one way of ? :
        "h = 1.0 - h;",
        "h = h > 3.0 ? h : 1.0 - h;",
        "h = twice(max(h, 1.5), 0.5);",  # += to =
        "float h = gain;",  # a sign
        "return texelFetch(terrain, texel, 0).r;",
        "return h + texelFetch(terrain, texel, 0);",  # a swizzle
        "return 0.0;",
        "if (true)",
        "i < 3;",  # a constant in the place of its name
        'output = "height:r32f")',  # no repeat
        'repeat = "1"',
        "const float gain = 2.5;",
        "uniform float gain = 1.0;\n",
        "uniform sampler2D terrain;  //! input\n",
    ],
)
def test_an_edit_gives(expected: str):
    text = tidy(TEXT)
    assert expected not in text
    assert any(expected in edited for edited in map(tidy, every_edit(text)))


def test_edits_come_to_an_end():
    """Taking any edit, over and over, comes to a text that has none left: no edit undoes another."""
    text = tidy(TEXT)
    for step in range(3000):
        result = [e for e in map(tidy, every_edit(text)) if e != text]
        if not result:
            break
        text = result[(7 * step) % len(result)]
    else:
        raise AssertionError("there is always another edit")


def test_zeros_are_not_put_in_where_they_would_be_the_defect():
    text = tidy("float f(float x) { return x / (x + 1.5); }")
    with_zero = list(edits.expressions(text))
    without = list(edits.expressions(text, edits.LITERALS_WITHOUT_ZERO))
    assert any("0.0" in edited for edited in with_zero)
    assert without
    assert not any("0.0" in edited or " 0" in edited for edited in without)


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("float f() { float x; return x; }", {"x"}),
        ("float f() { float x; x = 1.0; return x; }", set()),
        ("float f() { vec2 x; x.y = 1.0; return x.y; }", set()),
        ("float f() { float x; g(x); return x; }", set()),
        ("float f() { float x; if (x > 1.0) return 1.0; return 2.0; }", {"x"}),
        ("float f() { float x; return sqrt(1.0 + x); }", {"x"}),
        ("float f() { g(); }", {"f()"}),
        ("void f(out float x) { } void g() { float x; f(x); }", {"x"}),
        ("float f() { if (true) return 1.0; }", {"f()"}),
        ("float f() { if (true) { return 1.0; } return 2.0; }", set()),
        ("void f(out float x) { }", {"x"}),
        ("void f(out float x) { x = 1.0; }", set()),
    ],
)
def test_what_glsl_leaves_undefined_is_known(text, names):
    assert edits.undefined(tidy(text)) == names


def test_an_input_without_a_source_keeps_members_and_numbers() -> None:
    text = "uniform sampler2D f;  //! input\nfloat g = wired_f ? texture(f, uv).x + 1.f + wave.f : 0.0;\n"
    expected = text.replace("sampler2D f", "sampler2D no_f").replace("wired_f", "wired_no_f")
    assert unwired(text, "f") == expected.replace("texture(f", "texture(no_f")
