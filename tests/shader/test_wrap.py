"""The text around a kernel's lines: each driver's own, and nothing that the kernel does not need."""

from __future__ import annotations

import pytest

from playground.engine.software import specialise
from playground.errors import ShaderError
from playground.shader.header import parse_kernel
from playground.shader.source import read_source, with_calls_joined
from playground.shader.wrap import COMPUTE, FRAGMENT, wrap, wrap_library
from playground.sketch.model import Kernel, TexelKernel

ONE = """// a title
#include "lib.glsl"
#pragma kernel(output = "a:r16f", repeat = "3")
uniform float amount = 1.0;
float kernel(ivec2 texel) {
    return previous(texel) + amount * time;
}
"""


@pytest.fixture
def kernel(tmp_path):
    def make(text: str, name: str = "k.glsl") -> Kernel:
        (tmp_path / "lib.glsl").write_text("float one() {\n    return 1.0;\n}\n")
        path = tmp_path / name
        path.write_text(text)
        result = parse_kernel("k", read_source(path, (tmp_path,)))
        assert result is not None
        return result

    return make


@pytest.mark.parametrize(
    ("driver", "stage", "version"), [(FRAGMENT, "fragment", "330"), (COMPUTE, "compute", "430")]
)
def test_every_line_of_the_kernel_is_found_again(kernel, driver, stage, version):
    made = kernel(ONE)
    wrapped = wrap(made, driver)
    result = wrapped.stages[stage]
    lines = result.text.split("\n")
    assert lines[0] == f"#version {version}"
    seen = 0
    for number, text in enumerate(lines, 1):
        line = result.locate(number)
        if line is not None:
            assert line.code == text
            seen += 1
    assert seen == len(made.source.lines)
    assert result.locate(0) is None
    assert result.locate(1) is None
    assert result.locate(len(lines) + 1) is None


def test_only_what_the_text_names_is_given(kernel):
    text = wrap(kernel(ONE), FRAGMENT).stages["fragment"].text
    assert "uniform float time;" in text
    for name in ("spacing", "relief", "iteration", "eye", "size"):
        assert f" {name};" not in text


def test_both_drivers_get_the_same_lines(kernel):
    made = kernel(ONE)
    texts = [
        next(s for n, s in wrap(made, d).stages.items() if n != "vertex").text for d in (FRAGMENT, COMPUTE)
    ]
    assert all(made.source.code in text for text in texts)
    assert wrap(made, FRAGMENT) == wrap(made, FRAGMENT)


def test_no_line_directive_and_no_quotes_are_left(kernel):
    for driver in (FRAGMENT, COMPUTE):
        for stage in wrap(kernel(ONE), driver).stages.values():
            assert "#line" not in stage.text
            assert '"' not in stage.text
            assert stage.text.isascii()


def test_each_image_has_its_format_and_access(kernel):
    two = ONE.replace('"a:r16f"', '"a:r16f, b:rgba8"').replace(
        "float kernel(ivec2 texel) {\n    return previous(texel) + amount * time;",
        "void kernel(ivec2 texel, out float a, out vec4 b) {\n"
        "    a = previous_a(texel) + amount * time; b = vec4(a);",
    )
    text = wrap(kernel(two), COMPUTE).stages["compute"].text
    assert "layout(r16f, binding = 0) uniform writeonly image2D k_image_a;" in text
    assert "layout(rgba8, binding = 1) uniform writeonly image2D k_image_b;" in text
    visits = (
        two.replace('repeat = "3"', 'repeat = "3", visits = "1, 1"')
        + "ivec2 visit(ivec2 cell) { return cell; }\n"
    )
    text = wrap(kernel(visits), COMPUTE).stages["compute"].text
    assert "uniform image2D k_image_a;" in text, "read and written in place"
    assert "uniform writeonly image2D k_image_b;" in text, "never read"


DRAW = """#pragma draw(mesh = "grid", output = "frame:rgba16f")
uniform int grid = 9; //! slider(2, 99)
const vec3 UP = vec3(0.0, 0.0, 1.0);
float shade(vec3 n) { return dot(n, UP); }
vec4 vertex(vec3 corner, out vec3 position, out int which) {
    if (corner.x > 0.5) { position = corner; }
    which = int(corner.y * 4.0);
    return vec4(corner, 1.0);
}
// fragment( in a comment is not it
vec4 fragment(int which, vec3 position) {
    return vec4(dFdx(position), shade(position)) * float(which);
}
"""


def test_a_draw_becomes_two_stages_with_what_each_needs(kernel, ctx):
    made = kernel(DRAW)
    wrapped = wrap(made, "draw")
    vertex, fragment = wrapped.stages["vertex"], wrapped.stages["fragment"]
    assert "dFdx" not in vertex.text
    assert "invariant gl_Position;" in vertex.text, "draws of one mesh are held to equal depths"
    assert "corner" not in fragment.text.replace("k_", "")
    assert "flat out int k_to_which;" in vertex.text
    assert "flat in int k_to_which;" in fragment.text
    for stage in (vertex, fragment):
        numbers = [n for n in range(1, 40) if stage.locate(n) is not None]
        assert len(numbers) == len(made.source.lines), "blanked functions keep their lines"
    program = ctx.program(vertex_shader=vertex.text, fragment_shader=fragment.text)
    assert "k_in_corner" in list(program)
    program.release()


def test_a_fragment_may_take_less_and_in_any_order_but_not_more(kernel):
    wrap(
        kernel(DRAW.replace("int which, vec3 position", "vec3 position").replace("* float(which)", "")),
        "draw",
    )
    with pytest.raises(
        ShaderError,
        match="fragment takes float age, which vertex does not give; it gives vec3 position, int which",
    ):
        wrap(kernel(DRAW.replace("int which, vec3 position", "float age")), "draw")


def test_a_library_file_compiles_alone_by_both_drivers(kernel, ctx, tmp_path):
    source = read_source(tmp_path / "lib.glsl", (tmp_path,)) if (tmp_path / "lib.glsl").exists() else None
    if source is None:
        kernel(ONE)
        source = read_source(tmp_path / "lib.glsl", (tmp_path,))
    library = TexelKernel("lib", source, ())
    fragment = wrap_library(library, FRAGMENT)
    ctx.program(
        vertex_shader=fragment.stages["vertex"].text, fragment_shader=fragment.stages["fragment"].text
    ).release()
    if ctx.version_code >= 430:
        ctx.compute_shader(wrap_library(library, COMPUTE).stages["compute"].text).release()


PLAIN = "\n\n// words\n#version 330\nout vec4 c;\nvoid main() { c = vec4(1.0); }\n"


def test_a_plain_shader_is_left_as_it_is_but_for_its_blank_lines(kernel):
    stage = wrap(kernel(PLAIN, "p.frag"), FRAGMENT).stages["fragment"]
    lines = stage.text.split("\n")
    assert lines[3:6] == ["#version 330", "out vec4 c;", "void main() { c = vec4(1.0); }"]
    assert lines[:3] == ["//"] * 3, "Mesa counts no blank line above #version"
    located = stage.locate(5)
    assert located is not None
    assert located.number == 5


def test_choices_become_constants_and_nothing_else_moves(kernel):
    text = """#pragma kernel(output = "a:r16f")
uniform bool on = false;  //! Whether
uniform int  way=0;  //! menu("one", "other") Which
uniform int ways = 3;
float kernel(ivec2 texel) { return on ? float(way) : float(ways); }
"""
    plain = wrap(kernel(text), FRAGMENT)
    before = plain.stages["fragment"].text.split("\n")
    after = specialise(plain, (("on", 1), ("way", 1))).stages["fragment"].text.split("\n")
    changed = {b.strip(): a.strip() for b, a in zip(before, after, strict=True) if a != b}
    assert changed == {
        "uniform bool on = false;": "const   bool on = true;",
        "uniform int  way=0;": "const   int  way = 1;",
    }


# ── Macro calls that span lines are joined on their first; every other line stays where it is


SUM = "#define SUM(a, b) ((a) + (b))"


@pytest.mark.parametrize(
    ("lines", "joined"),
    [
        (["x = SUM(1,", "        2);", "y"], ["x = SUM(1, 2);", "", "y"]),
        (["x = SUM(1,", "", "  f(2),", "  );", "y"], ["x = SUM(1, f(2), );", "", "", "", "y"]),
        (["x = SUM", "  (1, 2);", "y"], ["x = SUM (1, 2);", "", "y"]),
        (
            ["x = SUM(1, 2) + SUM(", "3, SUM(4,", "5));", "y"],
            ["x = SUM(1, 2) + SUM( 3, SUM(4, 5));", "", "", "y"],
        ),
        (["x = SUM(1,", "2) + SUM(3,", "4);"], ["x = SUM(1, 2) + SUM(3, 4);", "", ""]),
        (["x = f(SUM(1, 2),", "3);"], ["x = f(SUM(1, 2),", "3);"]),
        (["x = SUMMER(1,", "2);"], ["x = SUMMER(1,", "2);"]),
        (["int SUM", "= 3;"], ["int SUM", "= 3;"]),
        (["x = SUM(1,", "never closed", "y"], ["x = SUM(1,", "never closed", "y"]),
        (["x = SUM(1,", "#ifdef A", "2);"], ["x = SUM(1,", "#ifdef A", "2);"]),
        (["x = SUM(1,", "2) + SUM(3", "never"], ["x = SUM(1,", "2) + SUM(3", "never"]),
    ],
)
def test_calls(lines, joined):
    assert with_calls_joined([SUM, *lines]) == [SUM, *joined]


def test_macro_alias_call_is_joined_and_plain_constant_is_not():
    text = [SUM, "#define ADD SUM", "#define PI 3.14", "ADD(1,", "2)", "PI * (1,", "2)"]
    assert with_calls_joined(text)[3:] == ["ADD(1, 2)", "", "PI * (1,", "2)"]


def test_before_its_definition_a_name_is_no_macro():
    assert with_calls_joined(["SUM(1,", "2)", SUM]) == ["SUM(1,", "2)", SUM]
