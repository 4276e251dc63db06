"""What a driver would pass over, or point elsewhere: each mistake has its own file and line."""

from __future__ import annotations

import os
import socket
from pathlib import Path

import pytest

from playground.engine.sandbox import Sandbox
from playground.errors import DataError, Diagnostic, ShaderError
from playground.verify.check import FileReport, check_file, find_files

from ..loading import load

KERNEL = '#pragma kernel(output = "height:r32f")\n'


@pytest.fixture(scope="module")
def sandbox():
    with Sandbox() as made:
        yield made


def placed(diagnostic: Diagnostic) -> tuple[str, int]:
    return Path(diagnostic.file).name, diagnostic.line


def checked(path: Path, sandbox: Sandbox) -> FileReport:
    return check_file(path, sandbox)


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
    report = checked(folder.write("a.glsl", text), sandbox)
    assert report.ok and [(placed(w), w.severity) for w in report.warnings] == [(("a.glsl", 2), "warning")]
    assert "#line is left out" in report.warnings[0].message
    report = checked(folder.write("a.glsl", text.replace("1.0;", "wrong;")), sandbox)
    assert placed(report.errors[0]) == ("a.glsl", 3)


# Places that a message lacks


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
    report = checked(folder.write("a.glsl", f'{KERNEL}#include "round.glsl"\n'), sandbox)
    assert placed(report.errors[0]) == ("round.glsl", 2) and "include cycle" in report.errors[0].message
    (folder.path / "latin.glsl").write_bytes(b"// fine\r\n// gr\xc3\xbcn, gr\xf6\xdfe\n")
    report = checked(folder.path / "latin.glsl", sandbox)
    assert placed(report.errors[0]) == ("latin.glsl", 2) and report.errors[0].column == 12
    report = checked(folder.write("a.glsl", f'{KERNEL}#include "latin.glsl"\n'), sandbox)
    error = report.errors[0]
    assert placed(error) == ("latin.glsl", 2) and [Path(c).name for c in error.chain] == ["a.glsl:2"]
    (folder.path / "sketch.toml").write_bytes(b"format = 1\n# \xff\n")
    assert placed(checked(folder.path / "sketch.toml", sandbox).errors[0]) == ("sketch.toml", 2)


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
    assert checked(folder.write("source.glsl", SOURCE), sandbox).ok
    report = checked(folder.write("source.glsl", f"{SOURCE}#define N 3\n  {code}\n"), sandbox)
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
        result = {path.name: checked(path, sandbox) for path, _ in find_files([folder.path])}
    assert result.pop("good.glsl").ok
    assert sorted(result) == ["pipe.glsl", "pipe.toml", "socket.frag"]
    for name, report in result.items():
        (error,) = report.errors
        what = "a socket" if name == "socket.frag" else "a FIFO"
        assert placed(error)[0] == name and f"this is {what}, not a file" in error.message
    with pytest.raises(DataError, match="this is a FIFO, not a file"):
        find_files([folder.path / "pipe.glsl"])
    report = checked(folder.write("good.glsl", f'{KERNEL}#include "pipe.glsl"\n'), sandbox)
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
    (result,) = checked(folder.write("a.glsl", text), sandbox).errors
    name = declared.split()[1]
    assert placed(result) == ("a.glsl", 3) and result.column == result.excerpt.index(name) + 1
    assert f"'{name}' is given to plain shaders only" in result.message and words in result.message


@pytest.mark.parametrize("declared", ["vec2 u_mouse = vec2(0.5);  //! point", "float frame = 3.0;"])
def test_one_that_is_meant_as_a_parameter_is_one(folder, sandbox, declared):
    name = declared.split()[1]
    text = f"{KERNEL}uniform {declared}\nfloat kernel(ivec2 texel) {{ return vec2({name}).x; }}\n"
    assert checked(folder.write("a.glsl", text), sandbox).ok


# Steps


REPEATS = f'{KERNEL[:-2]}, repeat = "5")\nfloat kernel(ivec2 texel) {{ return previous(texel) + 1.0; }}\n'


def test_steps_beyond_repeat_are_refused_and_shot_at_its_line(folder, sandbox, any_engine):
    shot = '[[shot]]\nname = "end"\nsteps = {{ a = {} }}\n'
    sketch = folder.one(REPEATS, more=shot.format(5))
    assert checked(folder.path / "sketch.toml", sandbox).ok
    assert (any_engine.read(sketch, "a", steps={"a": 5}) == 5.0).all()
    with pytest.raises(Exception, match="steps: 'a' stops after 6 steps, but it has 5 in all"):
        any_engine.read(sketch, "a", steps={"a": 6})
    folder.one(REPEATS, more=shot.format(99))
    (result,) = checked(folder.path / "sketch.toml", sandbox).errors
    assert placed(result) == ("sketch.toml", 6) and "shot 'end': steps: 'a' stops after 99" in result.message


def test_of_a_repeat_that_grows_with_time_they_are_reached_later(folder, any_engine):
    sketch = folder.one(REPEATS.replace('"5"', '"floor(time)"'))
    assert (any_engine.read(sketch, "a", steps={"a": 3}, time=2.0) == 2.0).all()
    assert (any_engine.read(sketch, "a", steps={"a": 3}, time=7.0) == 3.0).all()
