"""What ``check`` says of a file, and where; what opening the same file says is the same."""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest

from playground.engine.sandbox import Sandbox
from playground.errors import DataError, Diagnostic, PlaygroundError, ShaderError
from playground.paths import GLSL
from playground.verify.check import check_file, find_files

from ..loading import load


@pytest.fixture(scope="module")
def sandbox() -> Iterator[Sandbox]:
    with Sandbox() as made:
        yield made


def wrong(path: Path, sandbox: Sandbox) -> Diagnostic:
    report = check_file(path, sandbox)
    assert not report.ok
    assert "subject" not in json.dumps(report.as_json())
    return report.errors[0]


HEADERS = {
    "repeat": ("", ', repeat = "2 - size.x"', "float kernel(ivec2 texel) { return 1.0; }"),
    "visits": (
        "",
        ', repeat = "2", visits = "size.x / iteration, 1"',
        "ivec2 visit(ivec2 cell) { return cell; }\nfloat kernel(ivec2 texel) { return 1.0; }",
    ),
}


@pytest.mark.parametrize("what", HEADERS)
def test_a_header_that_is_wrong_is_reported_at_its_line(folder, sandbox, what):
    before, option, body = HEADERS[what]
    path = folder.write(
        "hills.glsl", f'// hills\n{before}\n#pragma kernel(output = "a:r32f"{option})\n{body}\n'
    )
    result = wrong(path, sandbox)
    assert (Path(result.file).name, result.line) == ("hills.glsl", 3), result
    assert result.message.startswith(f"pass 'hills': {what}")
    assert result.excerpt.startswith("#pragma kernel")


def test_a_compute_variant_s_groups_are_reported_at_its_own_line(folder, sandbox):
    if trial_has_no_compute(folder, sandbox):
        pytest.skip("this context has no compute shaders")
    folder.write(
        "hills.glsl", '#pragma kernel(output = "a:r32f")\nfloat kernel(ivec2 texel) { return 1.0; }\n'
    )
    text = '\n#pragma compute(groups = "size.x / (size.x - size.y), 1")\nvoid main() {}\n'
    result = wrong(folder.write("hills.comp", text), sandbox)
    assert (Path(result.file).name, result.line) == ("hills.comp", 2), result


def trial_has_no_compute(folder, sandbox: Sandbox) -> bool:
    path = folder.write(
        "any.glsl", '#pragma kernel(output = "a:r32f")\nfloat kernel(ivec2 t) { return 1.0; }\n'
    )
    return bool(check_file(path, sandbox).skipped)


def test_a_sketch_s_own_kernel_is_reported_at_its_header_too(any_engine, folder):
    sketch = folder.one(
        '// one\n#pragma kernel(output = "a:r32f", repeat = "2 - size.x")\n'
        "float kernel(ivec2 texel) { return 1.0; }\n"
    )
    with pytest.raises(PlaygroundError, match="gives -15") as caught:
        any_engine.read(sketch, "a")
    diagnostic = caught.value.diagnostics[0]
    assert (Path(diagnostic.file).name, diagnostic.line) == ("one.glsl", 2)


def test_a_part_of_a_sketch_is_checked_and_opened_by_one_rule(folder, sandbox):
    folder.write("lib.glsl", "float half_of(float x) { return 0.5 * x; }\n")
    part = folder.write(
        "parts/k.glsl",
        '#include "../lib.glsl"\n#pragma kernel(output = "height:r32f")\n'
        "float kernel(ivec2 texel) { return half_of(float(texel.x)); }\n",
    )
    assert "outside" in wrong(part, sandbox).message
    with pytest.raises(PlaygroundError, match="outside"):
        load(part)
    folder.write("sketch.toml", "")
    assert check_file(part, sandbox).ok
    load(part)


def test_shader_without_kernel_gets_same_error_in_check_and_load(folder, sandbox):
    bare = folder.write("bare.frag", "float x;\n")
    said = wrong(bare, sandbox).message
    assert said == "nothing to run: no main, mainImage or #pragma kernel"
    with pytest.raises(PlaygroundError) as caught:
        load(bare)
    assert caught.value.diagnostics[0].message == said


HOLE = '// h\n#pragma kernel(output = "height:r32f")\nuniform float root = -1.0; //! slider(-1, 1)\n'
ALL = HOLE + "float kernel(ivec2 texel) { return sqrt(root); }\n"
SOME = HOLE + "float kernel(ivec2 texel) { return texel.x == 1 ? sqrt(root) : 0.5; }\n"


def test_all_nan_output_fails_check_and_single_hole_passes(folder, sandbox):
    result = wrong(folder.write("all.glsl", ALL), sandbox)
    assert "output 'height': none of its 1089 texels is finite; the first is NaN" in result.message
    assert (Path(result.file).name, result.line) == ("all.glsl", 2)
    assert check_file(folder.write("some.glsl", SOME), sandbox).ok
    assert check_file(folder.write("none.glsl", ALL.replace("= -1.0;", "= 1.0;")), sandbox).ok


def test_a_sketch_may_have_no_hole_at_all(folder, sandbox):
    folder.write("some.glsl", SOME)
    text = 'format = 1\nsize = 33\n[[pass]]\nname = "height"\nuse = "./some"\n'
    sketch = folder.write("sketch.toml", text)
    result = wrong(sketch, sandbox)
    assert "pass 'height', output 'height': NaN at texel (1, 0)" in result.message
    assert (Path(result.file).name, result.line) == ("some.glsl", 2)
    folder.write("sketch.toml", text + "set = { root = 1.0 }\n")
    assert check_file(sketch, sandbox).ok


@pytest.mark.slow
def test_a_file_that_the_child_does_not_survive_is_not_read_here(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """2 GiB of holes, by columns, so that they are not read by rows: more than the child may take."""
    from playground.engine import file_sources

    def refuse(*_: object, **__: object) -> None:
        raise AssertionError("read by the parent")

    with (tmp_path / "heights.npy").open("wb") as file:
        head = {"descr": "<f8", "fortran_order": True, "shape": (16384, 16384)}
        np.lib.format.write_array_header_1_0(file, head)
        file.truncate(file.tell() + 8 * 16384**2)
    (tmp_path / "sketch.toml").write_text(
        'format = 1\n[[pass]]\nname = "height"\nuse = "generation/heightmap"\n'
        'set = { elevation = "heights.npy" }\n[view]\nuse = "view/map"\ninputs = { shown = "height" }\n',
        encoding="utf-8",
    )
    monkeypatch.setattr(file_sources, "open_elevation", refuse)
    with Sandbox(memory_bytes=2**30) as small:
        result = wrong(tmp_path / "sketch.toml", small)
    assert "not enough memory to read it" in result.message and "heights.npy" in result.message


LIBRARY = "float height_at(ivec2 texel);\nvoid count_step(inout int steps);\n"
READS = "float twice(ivec2 texel) { int n = 0; count_step(n); return 2.0 * height_at(texel); }\n"


def test_library_file_may_declare_functions_its_includer_defines(folder, sandbox):
    assert check_file(folder.write("march.glsl", LIBRARY + READS), sandbox).ok
    result = wrong(folder.write("slip.glsl", LIBRARY + READS.replace("height_at(", "hight_at(")), sandbox)
    assert (Path(result.file).name, result.line) == ("slip.glsl", 3), result


COUNTED = """#pragma draw(mesh = "sheet", instances = "min(list.y, 6)", output = "drawn:rgba32f")
uniform sampler2D list;  //! input
vec4 vertex(vec3 corner, out vec2 place) {
    place = corner.xy;
    return vec4(2.0 * corner.xy - 1.0, 0.0, 1.0);
}
vec4 fragment(vec2 place) { return texelFetch(list, ivec2(0), 0); }
"""


def test_an_input_that_counts_instances_is_a_whole_number(folder, sandbox):
    draw = folder.write("draw.glsl", COUNTED)
    assert check_file(draw, sandbox).errors == ()
    inner = '[[pass]]\nname = "a"\nuse = "./draw"\n[inputs]\nnumbers = "a.list"\n[outputs]\ndrawn = "a"\n'
    outer = inner.replace("./draw", "./inner").replace("a.list", "a.numbers").replace("numbers =", "rows =")
    assert check_file(folder.write("inner.toml", inner), sandbox).errors == ()
    assert check_file(folder.write("outer.toml", outer), sandbox).errors == ()
    fraction = folder.write("draw.glsl", COUNTED.replace("min(list.y, 6)", "list.y / 7"))
    assert "a whole number was expected" in check_file(fraction, sandbox).errors[0].message


FOLDERS = sorted(path.name for path in GLSL.iterdir() if path.is_dir())


@pytest.mark.slow
@pytest.mark.parametrize("name", FOLDERS)
def test_what_ships_is_checked_without_an_error(name, sandbox):
    reports = [check_file(path, sandbox, root) for path, root in find_files([GLSL / name])]
    assert [str(error) for report in reports for error in report.errors] == []


# ── What a driver would pass over, or point elsewhere: each mistake has its own file and line


KERNEL = '#pragma kernel(output = "height:r32f")\n'


def placed(diagnostic: Diagnostic) -> tuple[str, int]:
    return Path(diagnostic.file).name, diagnostic.line


# Lines that a driver would miscount


CALLS = """#define SUM(a, b, c) ((a) + (b) + (c))
float kernel(ivec2 texel) {
    float sum = SUM(1.0,
                    2.0,

                    3.0);
    return sum + wrong;
}
"""


def test_error_after_multiline_macro_call_has_its_own_line(folder, any_engine):
    sketch = folder.one(KERNEL + CALLS)
    with pytest.raises(ShaderError) as caught:
        any_engine.read(sketch, "a")
    assert placed(caught.value.diagnostics[0]) == ("one.glsl", 8)
    good = folder.one(KERNEL + CALLS.replace(" + wrong", ""))
    assert (any_engine.read(good, "a") == 6.0).all()


def test_error_inside_multiline_macro_call_has_its_first_line(folder, any_engine):
    sketch = folder.one(KERNEL + CALLS.replace("3.0)", "wrong)").replace("sum + wrong", "sum"))
    with pytest.raises(ShaderError) as caught:
        any_engine.read(sketch, "a")
    assert placed(caught.value.diagnostics[0]) == ("one.glsl", 4)


def test_a_plain_shader_s_macro_calls_keep_their_lines_too(folder, any_engine):
    text = "#version 330\n" + CALLS.replace("float kernel(ivec2 texel)", "out vec4 c;\nfloat f()")
    path = folder.write("t.frag", text + "void main() { c = vec4(f()); }\n")
    with pytest.raises(ShaderError) as caught:
        any_engine.render(load(path), size=(4, 4))
    assert placed(caught.value.diagnostics[0]) == ("t.frag", 9)


@pytest.mark.slow
def test_a_line_directive_moves_no_error_and_is_a_warning(folder, sandbox, any_engine):
    text = f"{KERNEL}#line 100\nfloat kernel(ivec2 texel) {{ return 1.0; }}\n"
    report = check_file(folder.write("a.glsl", text), sandbox)
    assert report.ok and [(placed(w), w.severity) for w in report.warnings] == [(("a.glsl", 2), "warning")]
    assert "#line is left out" in report.warnings[0].message
    report = check_file(folder.write("a.glsl", text.replace("1.0;", "wrong;")), sandbox)
    assert placed(report.errors[0]) == ("a.glsl", 3)


# Places that a message lacks


def test_what_only_desktops_take_is_a_warning_at_its_line(folder, sandbox):
    head = '#pragma kernel(output = "a:r32f")\nuniform float steep = 2;  //! slider(0, 4)\n'
    body = "float kernel(ivec2 texel) {\n    return pow(steep, 2)\n    ;\n}\n"
    report = check_file(folder.write("loose.glsl", head + body), sandbox)
    assert report.ok and [placed(warning) for warning in report.warnings] == [("loose.glsl", 4)]
    assert "`return pow(steep, 2.0)`" in report.warnings[0].message
    toy = "void mainImage(out vec4 c, vec2 p) {\n    c = fma(p.xyxy, vec4(1), vec4(0)) * 2;\n}\n"
    report = check_file(folder.write("toy.frag", toy), sandbox)
    assert [placed(w) for w in report.warnings if "fma()" in w.message] == [("toy.frag", 2)]


def test_recursion_is_reported_at_function_definition(folder, any_engine):
    text = (
        "int f(ivec2 n) { return n.x; }\n"
        "int f(int n);\nint g(int n) { return f(n - 1); }\n"
        "int f(int n) { return n < 1 ? 0 : g(n); }\n"
        "float kernel(ivec2 texel) { return float(f(texel.x)); }\n"
    )
    with pytest.raises(ShaderError) as caught:
        any_engine.read(folder.one(KERNEL + text), "a")
    assert {placed(d) for d in caught.value.diagnostics} == {("one.glsl", 4), ("one.glsl", 5)}
    assert all("recursion" in d.message for d in caught.value.diagnostics), caught.value


def test_include_cycle_and_invalid_utf8_are_reported_at_line(folder, sandbox):
    folder.write("round.glsl", '\n#include "a.glsl"\n')
    report = check_file(folder.write("a.glsl", f'{KERNEL}#include "round.glsl"\n'), sandbox)
    assert placed(report.errors[0]) == ("round.glsl", 2) and "include cycle" in report.errors[0].message
    (folder.path / "latin.glsl").write_bytes(b"// fine\r\n// gr\xc3\xbcn, gr\xf6\xdfe\n")
    report = check_file(folder.path / "latin.glsl", sandbox)
    assert placed(report.errors[0]) == ("latin.glsl", 2) and report.errors[0].column == 12
    report = check_file(folder.write("a.glsl", f'{KERNEL}#include "latin.glsl"\n'), sandbox)
    error = report.errors[0]
    assert placed(error) == ("latin.glsl", 2) and [Path(c).name for c in error.chain] == ["a.glsl:2"]
    (folder.path / "sketch.toml").write_bytes(b"format = 1\n# \xff\n")
    assert placed(check_file(folder.path / "sketch.toml", sandbox).errors[0]) == ("sketch.toml", 2)


# What is never compiled


SOURCE = """// source.glsl
#pragma source("elevation_file", output = "height:r32f")
uniform sampler2D elevation;         //! file
uniform ivec2 raw_size = ivec2(0);
uniform int packing = 0;             //! menu("grey", "rgb")
uniform int no_data = 0;             //! menu("refuse", "fill")
uniform int first_row = 0;           //! menu("north", "south")
uniform vec2 metres = vec2(0.0);
"""


@pytest.mark.parametrize("code", ["float half_of(float x) { return x / 2; }", "float f(", "const int N = 3;"])
def test_code_in_a_source_s_file_is_refused_at_its_line(folder, sandbox, code):
    assert check_file(folder.write("source.glsl", SOURCE), sandbox).ok
    report = check_file(folder.write("source.glsl", f"{SOURCE}#define N 3\n  {code}\n"), sandbox)
    (result,) = report.errors
    assert placed(result) == ("source.glsl", 10) and result.column == 3
    assert "nothing runs this code" in result.message


# What is no file


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="there are no pipes in this system's folders")
def test_fifos_and_sockets_are_refused_without_blocking(folder, sandbox, tmp_path_factory):
    folder.write("good.glsl", f"{KERNEL}float kernel(ivec2 texel) {{ return 1.0; }}\n")
    os.mkfifo(folder.path / "pipe.glsl")
    os.mkfifo(folder.path / "pipe.toml")
    os.mkfifo(folder.path / "pipe.png")
    near = tmp_path_factory.mktemp("s")
    with socket.socket(socket.AF_UNIX) as item:
        item.bind(str(near / "s.frag"))
        (near / "s.frag").rename(folder.path / "socket.frag")
        result = {path.name: check_file(path, sandbox) for path, _ in find_files([folder.path])}
    assert result.pop("good.glsl").ok
    assert sorted(result) == ["pipe.glsl", "pipe.toml", "socket.frag"]
    for name, report in result.items():
        (error,) = report.errors
        what = "a socket" if name == "socket.frag" else "a FIFO"
        assert placed(error)[0] == name and f"this is {what}, not a file" in error.message
    with pytest.raises(DataError, match="this is a FIFO, not a file"):
        find_files([folder.path / "pipe.glsl"])
    report = check_file(folder.write("good.glsl", f'{KERNEL}#include "pipe.glsl"\n'), sandbox)
    assert placed(report.errors[0]) == ("good.glsl", 2)
    assert "'pipe.glsl': this is a FIFO, not a file" in report.errors[0].message


# Names of other programs


@pytest.mark.parametrize(
    ("declared", "words"),
    [
        ("float iTime", "did you mean 'time'?"),
        ("float u_time = 0.0", "did you mean 'time'?"),
        ("int iFrame", "did you mean 'time'?"),
        ("vec3 iResolution", "did you mean 'size'?"),
        ("vec2 resolution", "did you mean 'size'?"),
        ("vec4 iMouse", "//! point"),
        ("vec2 mouse", "//! point"),
        ("vec4 u_date", "annotation"),
    ],
)
def test_a_uniform_of_a_plain_shader_is_refused_in_a_kernel(folder, sandbox, declared, words):
    text = f"{KERNEL}\nuniform {declared};\nfloat kernel(ivec2 texel) {{ return 1.0; }}\n"
    (result,) = check_file(folder.write("a.glsl", text), sandbox).errors
    name = declared.split()[1]
    assert placed(result) == ("a.glsl", 3) and result.column == result.excerpt.index(name) + 1
    assert f"'{name}' is given to plain shaders only" in result.message and words in result.message


@pytest.mark.parametrize("declared", ["vec2 u_mouse = vec2(0.5);  //! point", "float frame = 3.0;"])
def test_one_that_is_meant_as_a_parameter_is_one(folder, sandbox, declared):
    name = declared.split()[1]
    text = f"{KERNEL}uniform {declared}\nfloat kernel(ivec2 texel) {{ return vec2({name}).x; }}\n"
    assert check_file(folder.write("a.glsl", text), sandbox).ok


# Steps


REPEATS = f'{KERNEL[:-2]}, repeat = "5")\nfloat kernel(ivec2 texel) {{ return previous(texel) + 1.0; }}\n'


def test_steps_beyond_repeat_are_refused_and_shot_at_its_line(folder, sandbox, any_engine):
    shot = '[[shot]]\nname = "end"\nsteps = {{ a = {} }}\n'
    sketch = folder.one(REPEATS, more=shot.format(5))
    assert check_file(folder.path / "sketch.toml", sandbox).ok
    assert (any_engine.read(sketch, "a", steps={"a": 5}) == 5.0).all()
    with pytest.raises(Exception, match="steps: 'a' stops after 6 steps, but it has 5 in all"):
        any_engine.read(sketch, "a", steps={"a": 6})
    folder.one(REPEATS, more=shot.format(99))
    (result,) = check_file(folder.path / "sketch.toml", sandbox).errors
    assert placed(result) == ("sketch.toml", 6) and "shot 'end': steps: 'a' stops after 99" in result.message


def test_of_a_repeat_that_grows_with_time_they_are_reached_later(folder, any_engine):
    sketch = folder.one(REPEATS.replace('"5"', '"floor(time)"'))
    assert (any_engine.read(sketch, "a", steps={"a": 3}, time=2.0) == 2.0).all()
    assert (any_engine.read(sketch, "a", steps={"a": 3}, time=7.0) == 3.0).all()
