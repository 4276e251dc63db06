"""Kernels' headers: what each declares, when it is read again, and what a text is without one."""

from __future__ import annotations

import os
import random
from contextlib import suppress
from pathlib import Path

import pytest

from playground.errors import ParameterError, PlaygroundError, ShaderError
from playground.paths import GLSL
from playground.shader.dialect import Dialects, check_name
from playground.shader.header import parse_kernel, parsed_kernel
from playground.shader.kernel import PRAGMAS, options_of
from playground.shader.source import read_source
from playground.sketch.model import Kernel, Parameter
from playground.sketch.techniques import read_kernel

from ..cases import each

KERNEL = '#pragma kernel(output = "height:r32f")\n'


@pytest.fixture
def parse(tmp_path):
    def parse_(text: str, name: str = "main.glsl") -> Kernel | None:
        path = tmp_path / name
        path.write_text(text, encoding="utf-8")
        return parse_kernel("main", read_source(path, (tmp_path,)))

    return parse_


@pytest.fixture
def parameter(parse):
    def parameter_(line: str) -> Parameter:
        result = parse(KERNEL + line + "\n")
        assert result is not None
        return result.parameters[0]

    return parameter_


# What a header says


def test_a_kernel_s_header(parse):
    result = parse(
        """\
// main.glsl -- terrain by halving.
#pragma kernel(output = "height:r32f, water:rgba16f", repeat = "2 * log2(size.x - 1)", \\
               accepts = "2**n + 1", visits = "size.x, 2 if iteration == 0 else steps")
uniform sampler2D before;  //! input("linear", "repeat", "mipmap")
uniform sampler2D light;   //! input("white")
uniform sampler2D grass;   //! file("textures/grass.png", "repeat") group("Ground") Blades
uniform int steps = 3;     //! slider(1, 9) unit("steps") label("How often") group("Time") Not \\
                           //  too often
"""
    )
    assert result.kind == "kernel" and result.title == "Terrain by halving"
    assert [(o.name, o.format, o.components, o.glsl) for o in result.outputs] == [
        ("height", "r32f", 1, "float"),
        ("water", "rgba16f", 4, "vec4"),
    ]
    assert (result.repeat, result.accepts) == ("2 * log2(size.x - 1)", "2**n + 1")
    assert result.visits == "size.x, 2 if iteration == 0 else steps"
    before, light = result.inputs
    assert (before.sampling.filter, before.sampling.wrap, before.sampling.mipmap) == (
        "linear",
        "repeat",
        True,
    )
    assert (light.fallback, light.sampling.filter, light.sampling.wrap) == ("white", "nearest", "clamp")
    assert result.needs_inputs == ("before",)
    grass, steps = result.parameters
    assert (grass.default, grass.group, grass.tooltip, grass.sampling.wrap) == (
        "textures/grass.png",
        "Ground",
        "Blades",
        "repeat",
    )
    assert (steps.default, steps.unit, steps.label, steps.group, steps.title) == (
        3,
        "steps",
        "How often",
        "Time",
        "How often",
    )
    assert steps.tooltip.startswith("Not ") and steps.tooltip.endswith("too often")
    assert steps.line == 7


@pytest.mark.parametrize(
    ("line", "glsl", "default", "kind", "low", "high"),
    [
        ("uniform float a = 0.2;  //! slider(0, 1)", "float", 0.2, "slider", 0, 1),
        ("uniform float a = -.5e1f;", "float", -5.0, "number", None, None),
        ("uniform float a = 3;", "float", 3.0, "number", None, None),
        ("uniform float a;", "float", 0.0, "number", None, None),
        ("uniform highp float a = 2.;", "float", 2.0, "number", None, None),
        ("uniform int a = 0x1F;", "int", 31, "number", None, None),
        ("uniform int a = 017;", "int", 15, "number", None, None),
        (
            "uniform uint a = 4294967295u; //! slider(0, 4294967295)",
            "uint",
            2**32 - 1,
            "slider",
            0,
            2**32 - 1,
        ),
        ("uniform bool a = true;", "bool", True, "checkbox", None, None),
        ("uniform bool a; //! checkbox", "bool", False, "checkbox", None, None),
        ("uniform vec2 a = vec2(135.0, 25.0); //! direction", "vec2", (135.0, 25.0), "direction", None, None),
        ("uniform vec3 a = vec3(1); //! colour", "vec3", (1.0, 1.0, 1.0), "colour", None, None),
        ("uniform vec4 a = vec4( 0.1 , 2u,3, 4.f );", "vec4", (0.1, 2.0, 3.0, 4.0), "number", None, None),
        ("uniform ivec2 a = ivec2(1.7, -1.7);", "ivec2", (1, -1), "number", None, None),
        ("uniform float a = 10.0; //! log_slider(0.1, 500)", "float", 10.0, "log_slider", 0.1, 500),
        ("uniform float a = 90.0; //! angle", "float", 90.0, "angle", -360, 360),
        ("uniform float a = 9.0; //! angle(0, 90)", "float", 9.0, "angle", 0, 90),
        ("uniform vec2 a = vec2(0.5); //! point", "vec2", (0.5, 0.5), "point", 0, 1),
        ('uniform int a = 1; //! menu("x", "y")', "int", 1, "menu", None, None),
    ],
)
def test_a_parameter(parameter, line, glsl, default, kind, low, high):
    result = parameter(line)
    assert (result.name, result.type, result.widget.kind) == ("a", glsl, kind)
    assert result.default == default and type(result.default) is type(default)
    assert (result.widget.low, result.widget.high) == (low, high)
    assert result.line == 2 and Path(result.file).name == "main.glsl"


@pytest.mark.parametrize(
    ("note", "kind", "tooltip"),
    [
        ("slider(0, 1) angle of the slope", "slider", "angle of the slope"),
        ("slider(0, 1) step by step", "slider", "step by step"),
        ("slider(0, 1) f(x) over x", "slider", "f(x) over x"),
        ("Roughness: a step(wise) word", "number", "Roughness: a step(wise) word"),
        ("unit of height", "number", "unit of height"),
        ('slider(0, 1) unit("m (up), \\"z\\"") Höhe → oben', "slider", "Höhe → oben"),
        ("", "number", ""),
        ("angle", "angle", ""),
    ],
)
def test_a_tooltip_begins_where_the_calls_end(parameter, note, kind, tooltip):
    result = parameter(f"uniform float a = 0.5; //! {note}")
    assert (result.widget.kind, result.tooltip) == (kind, tooltip)
    if "unit(" in note:
        assert result.unit == 'm (up), "z"'


def test_the_parts_of_a_vector_have_names(parameter):
    result = parameter('uniform vec4 a; //! slider(0, 1) parts("SW", "SE", "NW", "NE") Heights')
    assert result.parts == ("SW", "SE", "NW", "NE") and result.tooltip == "Heights"
    assert parameter("uniform vec4 a; //! slider(0, 1)").parts == ()


def test_brackets_and_commas_in_a_menu_s_names(parameter):
    result = parameter('uniform int a = 0; //! menu("plain (thesis)", "a, b", "c) d") Which')
    assert result.widget.choices == ("plain (thesis)", "a, b", "c) d") and result.tooltip == "Which"


def test_the_choice_of_previews_is_one_of_the_menu_s(parameter):
    assert parameter('uniform int a = 0; //! menu("x", "y") preview("y") Which').widget.preview == 1
    assert parameter('uniform int a = 0; //! menu("x", "y") Which').widget.preview is None
    assert parameter("uniform int a = 9; //! slider(0, 20) preview(5) Many").widget.preview == 5


def test_a_library_file_declares_nothing(parse):
    assert parse("float f(float x) { return x; }\n#pragma optimize(on)\n") is None
    assert parse("") is None
    assert parse('/* #pragma kernel(output = "h:r32f") */\n// #pragma kernel(\n') is None


def test_included_kernel_provides_functions_and_parameters_alone(parse, tmp_path):
    (tmp_path / "other.glsl").write_text('#pragma kernel(output = "x:r8")\nuniform float gain = 1.0;\n')
    result = parse(KERNEL + '#include "other.glsl"\n')
    assert [o.name for o in result.outputs] == ["height"] and [p.name for p in result.parameters] == ["gain"]
    assert parse('#include "other.glsl"\n') is None


def test_a_guarded_file_may_come_twice_by_two_ways(parse, tmp_path):
    (tmp_path / "base.glsl").write_text("#ifndef B\n#define B\nuniform float gain = 1.0;\n#endif\n")
    for name in "ab":
        (tmp_path / f"{name}.glsl").write_text('#include "base.glsl"\n')
    result = parse(KERNEL + '#include "a.glsl"\n#include "b.glsl"\n')
    assert [p.name for p in result.parameters] == ["gain"]


@pytest.mark.parametrize(
    ("text", "title"),
    [
        ("// terrain.glsl -- a slope.\n", "A slope"),
        ("// land.frag: a slope.\n", "A slope"),
        ("// A slope\n", "A slope"),
        ("//////////////\n// -----\n// A slope\n", "A slope"),
        ("#version 330\n\n// A slope\n", "A slope"),
        ("float x;\n// no title\n", ""),
        ('#include "lib.glsl"\n// mine\n', "Mine"),
        ("// terrain.glsl -- sRGB's curve: NaN stays NaN.\n", "sRGB's curve: NaN stays NaN"),
        ("// terrain.glsl -- a slope: " + "long " * 20 + "\n", "A slope"),
        ("// NaN. Or not …\n", "NaN. Or not …"),
        ("", ""),
    ],
)
def test_a_title_is_the_file_s_first_sentence(parse, tmp_path, text, title):
    (tmp_path / "lib.glsl").write_text("// lib.glsl -- a library.\n")
    result = parse(text + ("void main() {}\n" if "#version" in text else KERNEL))
    assert result.title == title


def test_sources_draws_and_compute_variants(parse):
    result = parse('#pragma source("elevation_file", output = "height:r32f")\n')
    assert (result.kind, result.registry, result.outputs[0].name) == ("source", "elevation_file", "height")
    result = parse(
        '#pragma draw(mesh = "grid", blend = "alpha", depth = "none", repeat = "1 if sea else 0")\n'
        "uniform bool sea;\n"
    )
    assert (result.kind, result.mesh, result.blend, result.depth) == ("draw", "grid", "alpha", "none")
    assert (result.outputs[0].name, result.outputs[0].format) == ("frame", "rgba16f")
    assert (result.count, result.samples) == ("", 0)
    result = parse(
        '#pragma draw(mesh = "triangles", count = "2 * points + size.x", samples = 1)\nuniform int points;\n'
    )
    assert (result.count, result.samples) == ("2 * points + size.x", 1)
    table = '#pragma draw(mesh = "triangles", count = "t.size.x // 3")\nuniform sampler2D t;  //! input\n'
    assert parse(table).count == "t.size.x // 3"
    result = parse(
        '#pragma compute(groups = "size.y, 1", local = "256, 1", '
        'buffers = "stack:vec4:size.x * 64; n:uint:1")\n'
    )
    assert (result.kind, result.groups, result.local) == ("compute", "size.y, 1", (256, 1))
    assert [(b.name, b.type, b.count) for b in result.storage.buffers] == [
        ("stack", "vec4", "size.x * 64"),
        ("n", "uint", "1"),
    ]


def test_plain_shaders(parse):
    text = """#version 330
// A plain one
uniform float iTime; uniform vec3 iResolution;
uniform float gain = 2.0; //! slider(0, 4)
uniform vec4 list[4];
uniform mat4 matrix;
uniform int computed = 1 + 2
  * 3;
out vec4 colour;
void main() { colour = vec4(texture2D(x, gl_FragCoord.xy)); }
"""
    result = parse(text)
    assert (result.kind, result.title) == ("plain_fragment", "A plain one")
    assert [p.name for p in result.parameters] == ["gain"]
    text = "#version 430\nlayout(local_size_x = 16, local_size_y = 8) in;\n"
    text += "layout(rgba16f, binding = 0) writeonly uniform image2D picture;\nvoid main() {}\n"
    result = parse(text)
    assert (result.kind, result.local, result.outputs[0].format) == ("plain_compute", (16, 8), "rgba16f")


@each("path", sorted(GLSL.rglob("*.glsl")), ids=lambda p: p.stem)
def test_every_shipped_file_has_a_header_that_can_be_read(path):
    kernel = read_kernel(path, GLSL)
    if kernel is not None:
        assert kernel.title and kernel.outputs
        assert all(p.tooltip for p in kernel.parameters)


def test_the_readme_lists_every_option_of_a_pragma():
    pragmas: dict[tuple[str, str], list[str]] = {}
    for pragma, kind in PRAGMAS.items():
        for name, row in options_of(kind).items():
            pragmas.setdefault((name, row.about), []).append(pragma)
    rows = [f"| `{name}` | {', '.join(kinds)} | {about} |" for (name, about), kinds in pragmas.items()]
    table = "\n".join(["| option | of | says |", "|---|---|---|", *rows])
    assert f"\n\n{table}\n\n" in (GLSL / "README.md").read_text("utf-8"), table


# Mistakes


def test_a_mistake_in_an_included_file_is_reported_there(parse, tmp_path):
    (tmp_path / "lib.glsl").write_text("\nuniform float a = x;\n")
    with pytest.raises(ShaderError) as caught:
        parse(KERNEL + '#include "lib.glsl"\n')
    diagnostic = caught.value.diagnostics[0]
    assert (Path(diagnostic.file).name, diagnostic.line, diagnostic.column) == ("lib.glsl", 2, 19)
    assert [Path(position).name for position in diagnostic.chain] == ["main.glsl:2"]


def test_columns_point_at_the_word(parse):
    with pytest.raises(ShaderError) as caught:
        parse(KERNEL + "uniform float step = 1.0;\n")
    assert caught.value.diagnostics[0].column == 15


def test_no_line_is_too_long_for_its_pattern(parse):
    for line in (
        "uniform float a =" + " " * 20_000,
        "uniform float a = " + "1" * 20_000,
        "uniform float a = " + "1 " * 20_000 + ";",
        "uniform float a; //! slider(" + " " * 20_000,
        "uniform float a; //! " + "slider " * 5_000,
        'uniform float a; //! unit("' + "\\" * 20_000,
        "#pragma kernel(" + "a" * 20_000 + ")",
        "#pragma kernel(" + "a = " * 5_000 + ")",
    ):
        with suppress(ShaderError):
            parse(KERNEL.replace("kernel", "optimize") + KERNEL + line)
    with pytest.raises(ShaderError, match="must be a whole literal"):
        parse(f"{KERNEL}uniform int a = {'9' * 5000};\n")


# A quarter of the texts every day, for they are made by chance: the others are no different.
@pytest.mark.parametrize("seed", [5, *(pytest.param(n, marks=pytest.mark.slow) for n in (105, 205, 305))])
def test_mutated_headers_raise_nothing_but_sentences(parse, seed):
    rng = random.Random(seed)
    texts = [p.read_text() for p in sorted(GLSL.rglob("*.glsl"))[:40]]
    texts = ["\n".join(line for line in t.split("\n") if "include" not in line)[:3000] for t in texts]
    for _ in range(375):
        letters = list(rng.choice(texts))
        for _ in range(rng.randint(1, 6)):
            if rng.random() < 0.5 or not letters:
                at = rng.randint(0, len(letters))
                letters.insert(
                    at,
                    rng.choice(
                        [*'()",=;:[]{}\\/*!#', "uniform ", "//! ", "#pragma ", "vec2", "9", "-", "é", "\n"]
                    ),
                )
            else:
                at = rng.randrange(len(letters))
                del letters[at : at + rng.randint(1, 8)]
        try:
            parse("".join(letters))
        except PlaygroundError as error:
            assert error.diagnostics[0].file and error.diagnostics[0].message


# Macros


def test_a_macro_of_any_other_name_may_stand(parse):
    assert parse(KERNEL + "#define sizes 3\n#define FAR (size.x * 2)\n") is not None


# ── Kernels are parsed again when anything they were made of is another, and only then


PARTED = """#include "part.glsl"
#pragma kernel(output = "height:r32f")
float kernel(ivec2 texel) { return part(); }
"""
PART = "float part() { return 1.0; }\n"


@pytest.fixture
def files(tmp_path):
    (tmp_path / "inner").mkdir()
    (tmp_path / "inner" / "k.glsl").write_text(PARTED)
    (tmp_path / "part.glsl").write_text(PART)
    return tmp_path


def read(files):
    return parsed_kernel("k", files / "inner" / "k.glsl", (files,))


def test_the_same_files_give_the_same_object(files):
    assert read(files) is read(files)


def test_a_change_within_one_tick_and_of_the_same_length_is_seen(files):
    before, part = read(files), files / "part.glsl"
    stat = part.stat()
    part.write_text(PART.replace("1.0", "2.0"))
    os.utime(part, ns=(stat.st_atime_ns, stat.st_mtime_ns))
    assert "2.0" in read(files).source.code
    part.write_text(PART)
    assert read(files) == before


def test_an_include_that_appears_in_a_nearer_place_is_taken(files):
    read(files)
    (files / "inner" / "part.glsl").write_text(PART.replace("1.0", "3.0"))
    assert "3.0" in read(files).source.code
    (files / "inner" / "part.glsl").unlink()
    assert "1.0" in read(files).source.code


def test_an_include_that_goes_is_missed_and_found_again(files):
    read(files)
    (files / "part.glsl").unlink()
    with pytest.raises(ShaderError, match=r"part\.glsl"):
        read(files)
    (files / "part.glsl").write_text(PART)
    assert "1.0" in read(files).source.code


def test_retargeted_symlink_is_detected_despite_equal_text(files):
    (files / "one.glsl").write_text(PART)
    (files / "two.glsl").write_text(PART)
    (files / "part.glsl").unlink()
    (files / "part.glsl").symlink_to("one.glsl")
    assert any(file.endswith("one.glsl") for file in read(files).source.files)
    (files / "part.glsl").unlink()
    (files / "part.glsl").symlink_to("two.glsl")
    assert any(file.endswith("two.glsl") for file in read(files).source.files)


VARIANT = """#pragma compute(groups = "(size.x + 7) / 8, (size.y + 7) / 8")
void main() {}
"""


def test_kernel_and_variant_stay_cached_until_either_changes(files):
    path = files / "inner" / "k.glsl"
    path.with_suffix(".comp").write_text(VARIANT)
    first = read_kernel(path, files)
    assert first.variants and read_kernel(path, files) is first
    path.with_suffix(".comp").write_text(VARIANT.replace("{}", "{ }"))
    second = read_kernel(path, files)
    assert second.variants[0].technique.source.code != first.variants[0].technique.source.code
    (files / "part.glsl").write_text(PART.replace("1.0", "2.0"))
    third = read_kernel(path, files)
    assert third.variants == second.variants and "2.0" in third.source.code


# ── Without a room that reads other tools' shaders: our own kernels and plain shaders, and nothing e


OWN = '#pragma kernel(output = "height:r32f")\nfloat kernel(ivec2 texel) { return 0.5; }\n'
PLAIN = "#version 330\nout vec4 colour;\nvoid main() { colour = vec4(1.0); }\n"
TOY = "void mainImage(out vec4 c, in vec2 p) { c = vec4(1.0); }\n"


@pytest.mark.parametrize(
    ("text", "name"),
    [
        (OWN, "own"),
        (PLAIN, "own"),
        (TOY, ""),
        ("// #pragma kernel\n", ""),
        ("void main() { gl_FragColor = vec4(1.0); }\n", ""),
        ("#version 330\nfloat twice(float x) { return 2.0 * x; }\n", ""),
    ],
    ids=["kernel", "plain", "toy", "comment", "old", "library"],
)
def test_without_a_room_only_our_own_texts_have_a_name(text, name):
    assert Dialects().name_of(text) == name


def test_without_a_room_a_json_is_no_shader(tmp_path):
    path = tmp_path / "a.json"
    path.write_text('{"renderpass": []}', encoding="utf-8")
    alone = Dialects()
    assert not alone.endings and not alone.is_export(path)
    assert alone.image_of(tmp_path) is None and not alone.is_inside(path)
    assert alone.read(path, "a", tmp_path, lambda use, folder, root: pytest.fail(use)) is None


def test_a_dialect_that_is_none_is_named_with_those_there_are():
    assert check_name("") == "" and check_name("own") == "own"
    with pytest.raises(ParameterError, match="--dialect nothing: no such dialect"):
        check_name("nothing")
