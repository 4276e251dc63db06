"""GLSL taken apart and put together: what is printed means the same, and every edit makes it simpler."""

from __future__ import annotations

from pathlib import Path

import moderngl
import pytest

from playground.errors import PlaygroundError
from playground.paths import GLSL
from playground.shader.header import parse_kernel
from playground.shader.source import read_source
from playground.shader.syntax.tokens import tokenize
from playground.shader.wrap import wrap
from playground.sketch.techniques import read_kernel
from playground.verify.reduce.case import unwired, written_out
from playground.verify.reduce.edits import NUMBERS_WITHOUT_ZERO, Candidates, tidy

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


def tokens_of(text: str) -> list[str]:
    return [token.text.rstrip() for token in tokenize(text)[0]]


@pytest.mark.slow
@each("path", sorted(GLSL.rglob("*.glsl")), ids=lambda p: p.stem)
def test_tidying_changes_no_token_and_is_done_once(path: Path):
    text = path.read_text(encoding="utf-8")
    assert tokens_of(tidy(text)) == tokens_of(text)
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


def test_lists_have_every_declaration_and_statement():
    text = tidy(TEXT)
    lists = [[text[slice(*place)].split("\n")[0] for place in items] for items in Candidates(text).lists()]
    assert [line.split(" ")[0] for line in lists[0]] == [
        "#pragma", "uniform", "uniform", "const", "struct", "float", "float"
    ]  # fmt: skip
    assert ["vec3 to;", "float size;"] in lists
    assert ["h = h > 3.0 ? sqrt(h) : 1.0 - h;"] in lists
    assert ["return 2.0 * x;"] in lists


def test_a_condition_is_one_item_with_what_it_leaves_out():
    text = "float a;\n#ifdef NO\nfloat b;\n#else\nfloat c;\n#endif\n#define M float d; float e;\nM\n"
    lists = Candidates(text).lists()
    assert [text[slice(*place)].split("\n")[0] for place in lists[0]] == [
        "float a;", "#ifdef NO", "#define M float d; float e;", "M"
    ]  # fmt: skip


def every_edit(text: str) -> list[str]:
    candidates = Candidates(text)
    return [
        *candidates.simplified(),
        *candidates.headers(),
        *candidates.without_parameter(),
        *candidates.inlined(),
        *candidates.constants({"gain": "2.5"}),
        *candidates.unwrapped(),
        *candidates.without_unused(),
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
        "int i = 0;\n    h += twice(max(h, 1.5), 0.5);\n",  # a loop's first iteration
        "    h -= 1.0;\n    return",  # a way of an if
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
    without = list(Candidates(text, NUMBERS_WITHOUT_ZERO).simplified())
    assert any("0.0" in edit for edit in Candidates(text).simplified())
    assert without
    assert not any("0.0" in edit or " 0" in edit for edit in without)


@pytest.mark.parametrize(
    ("body", "gives"),
    [
        ("return (a + b) * sin(a);", "return a * sin(a);"),
        ("return sqrt(a + b) * a;", "return (a + b) * a;"),  # in brackets where it must
        ("return a - sqrt(b - a);", "return a - (b - a);"),
        ("return sqrt(a * b) + a;", "return a * b + a;"),
        ("return -sqrt(-a);", "return - -a;"),
        ("return float(c.x) * a;", "return c.x * a;"),  # converted by itself
        ("vec3 v = vec3(a, b, 1.0); return v.y;", "vec3 v = vec3(b); return v.y;"),
        ("return dot(v, vec2(a, b));", "return dot(v, vec2(a));"),
        ("v += vec2(a, b); return v.x;", "v += a; return v.x;"),  # a scalar beside a vector
        ("return TWICE(sqrt(a));", "return TWICE(a);"),  # what a macro is handed
        ("return TWICE(sqrt(a));", "return sqrt(a);"),
        ("return c.x > 0 ? a : b;", "return b;"),
    ],
)
def test_a_part_of_its_type_replaces_an_expression(body: str, gives: str) -> None:
    head = "#define TWICE(x) (2.0 * x)\nfloat f(float a, float b, ivec2 c, vec2 v) {"
    text = f"{head} {body} }}\n"
    assert tidy(f"{head} {gives} }}\n") in map(tidy, Candidates(text).simplified())


@pytest.mark.parametrize(
    ("text", "never"),
    [
        ("void f(out float x) { x = 1.0; } void g() { float y; f(y); }", "f(0.0)"),
        ("void g() { float y[3]; y[1 + 1] = 2.0; }", "y[0.0]"),
        ("void g(float x) { for (int i = 0; i < 9; i++) x += 1.0; }", "; 0)"),
        ("void g(float x) { for (int i = 0; i < 9; i++) x += 1.0; }", "true"),
        ("int g(float x) { return int(x) << 2; }", "return x"),
        ("float g(int x) { return float(x); }", "return x"),  # drivers convert no result
        ("float g(float x) { return x; } float h() { return g(1.0); }", "g()"),
    ],
)
def test_what_cannot_compile_or_end_is_not_proposed(text: str, never: str) -> None:
    assert not any(never in tidy(edit) for edit in every_edit(text))


UNUSED = """float used(float x) { return x; }
float idle(float x) { return idle_too(x); }
const float LEFT = 1.0, RIGHT = 2.0;
struct Left { float x; };
struct Right { float x; };
float both(Right right) { return right.x; }
float kernel(ivec2 texel) {
    float set;
    set = 3.0;
    float rest = RIGHT;
    return used(rest) + both(Right(rest));
}
"""


def test_what_nothing_reads_goes_at_once():
    text = tidy(next(iter(Candidates(UNUSED).without_unused())))
    assert "idle" not in text and "set" not in text and "LEFT" not in text
    assert "Left" not in text and "struct Right" in text
    assert "float used(" in text and "RIGHT = 2.0;" in text and "rest = RIGHT;" in text


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    ["generation/gradient_noise/warping", "lighting/l_dot_n", "sky/ridges", "view/shaded"],
)
def test_candidates_compile(ctx: moderngl.Context, tmp_path: Path, name: str) -> None:
    """Of each kind, and of a hundred simpler expressions, at least 99 in a hundred."""
    kernel = read_kernel(GLSL / f"{name}.glsl", GLSL)
    assert kernel is not None
    candidates = Candidates(written_out(kernel))
    texts = [
        *candidates.inlined(),
        *candidates.stubs(),
        *candidates.without_unused(),
        *candidates.unwrapped(),
    ]
    simplified = list(candidates.simplified())
    texts += simplified[:: max(1, len(simplified) // 100)]
    path = tmp_path / "k.glsl"
    refused = [text for text in texts if not compiles(ctx, path, text)]
    assert len(texts) > 100
    assert len(refused) <= 0.01 * len(texts), refused[0]


def compiles(ctx: moderngl.Context, path: Path, text: str) -> bool:
    try:
        kernel = parse_kernel("k", read_source(path, (), {str(path.resolve()): text}))
        assert kernel is not None
        stages = wrap(kernel, "fragment", 330).stages
        ctx.program(**{f"{kind}_shader": stage.text for kind, stage in stages.items()}).release()
    except (PlaygroundError, moderngl.Error):
        return False
    return True


@pytest.mark.parametrize(
    ("text", "names"),
    [
        ("float f() { float x; return x; }", {"x"}),
        ("float f() { float x; x = 1.0; return x; }", set()),
        ("float f() { vec2 x; x.y = 1.0; return x.y; }", set()),
        ("float f() { float x; g(x); return x; }", set()),
        ("void g(float y) {} float f() { float x; g(x); return x; }", {"x"}),
        ("float f() { float x; float y = modf(1.5, x); return x + y; }", set()),
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
    assert Candidates(text).undefined == names


def test_an_input_without_a_source_keeps_members_and_numbers() -> None:
    text = "uniform sampler2D f;  //! input\nfloat g = wired_f ? texture(f, uv).x + 1.f + wave.f : 0.0;\n"
    expected = text.replace("sampler2D f", "sampler2D no_f").replace("wired_f", "wired_no_f")
    assert unwired(text, "f") == expected.replace("texture(f", "texture(no_f")
    text = "struct S { float f; };\n#ifdef X\nfloat a = b(f);\n#endif\n#define M f\n"
    assert unwired(text, "f") == text.replace("b(f)", "b(no_f)").replace("M f", "M no_f")


def test_what_nothing_declares_is_known():
    text = "uniform float a; float f() { vec3 x = b(c) + towards_a; return x.x + wave(size) + sin(a); }"
    assert Candidates(text).undeclared == {"b", "c", "wave"}
