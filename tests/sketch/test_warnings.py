"""Warnings: what nothing reads, what is read too early, what divides to 0, what a file sets over."""

from __future__ import annotations

from contextlib import suppress
from dataclasses import replace
from pathlib import Path

import pytest

from playground.engine.sketch_warnings import (
    newly_shadowed,
    shadowed_by_files,
    unread,
    unused_locals,
    unwritten,
)
from playground.errors import Diagnostic, PlaygroundError
from playground.paths import GLSL
from playground.shader.source import read_source
from playground.sketch.load import load
from playground.sketch.model import Keyframe
from playground.sketch.techniques import read_kernel
from playground.sketch.warnings import unheeded, whole_divisions


def found_in(folder: Path, declared: str, body: str = "", pragma: str = "") -> list[str]:
    text = f'#pragma kernel(output = "height:r32f"{pragma})\n{declared}\n'
    text += f"float kernel(ivec2 texel) {{ {body} return 0.0; }}\n"
    (folder / "k.glsl").write_text(text, encoding="utf-8")
    kernel = read_kernel(folder / "k.glsl", folder)
    assert kernel is not None
    return [f"{d.severity} {d.line}:{d.column} {d.message}" for d in unread(kernel)]


def test_what_nothing_reads_is_a_warning_at_its_name(tmp_path: Path) -> None:
    assert found_in(tmp_path, "uniform float level = 0.5; //! slider(0, 1) level of it") == [
        "warning 2:15 nothing reads 'level', so it has no effect"
    ]
    assert found_in(tmp_path, "uniform sampler2D mask; //! input") == [
        "warning 2:19 nothing reads 'mask', so it has no effect"
    ]


@pytest.mark.parametrize(
    ("declared", "body", "pragma"),
    [
        ("uniform float level = 0.5;", "float a = level;", ""),
        ("uniform int steps = 5; //! slider(1, 9)", "", ', repeat = "steps"'),
        ("uniform float level = 0.5;\n#define HALF (0.5 * level)", "", ""),
        ("uniform sampler2D mask; //! input", "if (wired_mask) return 1.0;", ""),
        ("uniform float level = 0.5;\nfloat f() { return level; }", "", ""),
    ],
)
def test_what_anything_reads_is_none(tmp_path: Path, declared: str, body: str, pragma: str) -> None:
    assert found_in(tmp_path, declared, body, pragma) == []


def test_name_in_comment_or_longer_name_does_not_count_as_read(tmp_path: Path) -> None:
    body = "// level\n float levels = 1.0; /* level */"
    assert len(found_in(tmp_path, "uniform float level = 0.5;", body)) == 1


def test_the_library_has_none() -> None:
    seen = 0
    for path in sorted(GLSL.rglob("*.glsl")):
        try:
            kernel = read_kernel(path, GLSL)
        except PlaygroundError:
            continue  # files of sketches, which include from their own folder
        if kernel is not None:
            seen += 1
            assert (*unread(kernel), *unused_locals(kernel)) == (), path
    assert seen > 50


@pytest.mark.parametrize(
    ("declared", "body", "warnings"),
    [
        ("", "float rest = 2.0;", ["3:35 nothing reads 'rest'"]),
        ("", "float e = 1e3, f = 2.0f; e += f;", []),
        ("#define TWICE(x) float y = x; y * 2.0", "float rest = 2.0; TWICE(rest);", []),
        ("uniform float rest = 1.0;", "float rest = 2.0;", ["3:35 nothing reads 'rest'"]),
        ("", "{ float rest = 2.0; } float rest = 1.0; rest++;", ["3:37 nothing reads 'rest'"]),
        ('#include "noise/hash.glsl"', "float rest = 2.0;", ["3:35 nothing reads 'rest'"]),
        ("", "int i; for (int i = 0; i < 3; i++) {}", ["3:33 nothing reads 'i'"]),
        ("float half_of(float x, float unused) { return x; }", "", []),
    ],
)
def test_a_local_that_nothing_names(tmp_path: Path, declared: str, body: str, warnings: list[str]) -> None:
    found_in(tmp_path, declared, body)
    kernel = read_kernel(tmp_path / "k.glsl", tmp_path)
    assert kernel is not None
    assert [f"{d.line}:{d.column} {d.message}" for d in unused_locals(kernel)] == warnings


COUNTED = '#pragma kernel(output = "height:r32f")\nuniform int steps = 4;  //! slider(1, 9)\n'
COUNTED += "float kernel(ivec2 texel) { return 1.0; }\n"


@pytest.mark.parametrize(
    ("toml", "read"),
    [
        ('repeat = "2 * steps"\n[parameters]\nsteps = "a.steps"', True),
        ('size = ["2 * rounds", 1]\n[parameters]\nrounds = ["a.steps", "b.n"]', True),
        ('size = [1, "a.steps"]', True),
        ('size = "rounds"\n[parameters]\nrounds = "b.steps"', False),
        ('size = "steps"\n[parameters]\nsteps = "a.rounds"', False),
        ('size = "b.steps"', False),
        ('size = "2 +"', False),
    ],
)
def test_what_a_techniques_repeat_or_size_names_is_read(folder, toml: str, read: bool) -> None:
    path = folder.write("worn/finish.glsl", COUNTED)
    unheard = ["nothing reads 'steps', so it has no effect"]
    assert [each.message for each in unread(read_kernel(path, folder.path))] == unheard
    folder.write("worn/other.glsl", COUNTED)
    other = '[[pass]]\nname = "b"\nuse = "./worn/other"\n'
    folder.write("worn.toml", f'{other}[[pass]]\nname = "a"\nuse = "./worn/finish"\n{toml}\n')
    assert [each.message for each in unread(read_kernel(path, folder.path))] == ([] if read else unheard)


# ── divisions of whole numbers ───────────────────────────────────────────────


def divisions_in(folder: Path, code: str) -> list[Diagnostic]:
    body = f"float kernel(ivec2 texel) {{\n    float x = 1.0;\n    {code}\n    return x;\n}}\n"
    (folder / "k.glsl").write_text(HEAD + body, encoding="utf-8")
    kernel = read_kernel(folder / "k.glsl", folder)
    assert kernel is not None
    return list(unheeded(kernel))


HEAD = '#pragma kernel(output = "a:r32f")\nint whole = 3;\nint of(int k) { return k; }\n'
HEAD += "struct Part { int count; float share; };\nfloat at(int k) { return float(k); }\n"


@pytest.mark.parametrize(
    ("code", "written", "value"),
    [
        ("float a = 1/4;", "1/4", 0),
        ("float a = x + 3*1 / 4;", "3*1 / 4", 0),
        ("float a = 1/4*x;", "1/4", 0),
        ("float a = pow(x, 1 / 3);", "1 / 3", 0),
        ("vec2 a = vec2(0.5, 7/2);", "7/2", 3),
        ("float a = 2.0 * (1/3);", "1/3", 0),
        ("float a = (1+2)/4;", "(1+2)/4", 0),
        ("float a = x > 1.0 ? 2/3 : 0.0;", "2/3", 0),
        ("if (x < 1/2) x = 0.0;", "1/2", 0),
        ("for (float t = 0.0; t < 1.0; t += 1/8) x += t;", "1/8", 0),
        ("int a = int(4.0 * float(1/4));", "1/4", 0),
        ("x *= 3/2;", "3/2", 1),
        ("Part a; a.share = 1/4;", "1/4", 0),
        ("float a[2]; a[whole - 3] = 1/4;", "1/4", 0),
        ("vec2 v = vec2(0.0); v.x = 1/4;", "1/4", 0),
        ("x = max(x, 1/4);", "1/4", 0),
        ("x = clamp(x, 0.0, float(whole) * (1/4));", "1/4", 0),
        ("if (whole > 1) x = 1/4;", "1/4", 0),
    ],
)
def test_a_quotient_of_whole_literals_is_warned_of(
    tmp_path: Path, code: str, written: str, value: int
) -> None:
    (result,) = divisions_in(tmp_path, code)
    assert result.message.startswith(f"{written} divides whole numbers, which gives {value}; write ")
    assert (result.line, result.column) == (8, 5 + code.index(written))


@pytest.mark.parametrize(
    "code",
    [
        "int n = 7/2;",
        "const int n = 3, m = 7/2;",
        "float table[7/2];",
        "ivec2 n = ivec2(7/2, 3);",
        "for (int k = 0; k < 7/2; k++) x += 1.0;",
        "whole = 7/2;",
        "whole += 7/2;",
        "if (whole > 7/2) x = 2.0;",
        "x = float(of(7/2) * int(texel.x));",
        "x = at(7/2);",
        "Part a; a.count = 7/2;",
        "ivec2 v = ivec2(0); v.x = 7/2;",
        "int n[2]; n[1] += 7/2;",
        "float a = x * 1/4;",
        "float a = x/4;",
        "float a = 4/2;",
        "float a = 1.0/4.0 + 1./4. + .5/2.;",
        "uint n = 7u/2u;",
        "float a = float(3)/2;",
        "float a = x;  // 1/4",
        "x += float(whole + 7/2);",
        "x = float(whole << (7/2));",
        "x = float(texel.x / 2 * 2 + 1/2);",
        "bool a = (whole % 3) == 7/2;",
        "if (x > 0.0) whole = 7/2;",
        "whole = clamp(whole, 0, 7/2);",
        "int a = abs(whole - 7/2);",
        "switch (7/2) { default: x = 2.0; }",
    ],
)
def test_whole_quotients_that_are_meant_are_left_alone(tmp_path: Path, code: str) -> None:
    assert divisions_in(tmp_path, code) == []


def test_no_shipped_text_divides_whole_literals() -> None:
    texts = (read_source(path, [GLSL]) for path in GLSL.rglob("*.glsl"))
    assert [whole_division for text in texts for whole_division in whole_divisions(text)] == []


# ── variables that are read before they are written ──────────────────────────

_FUNCTIONS = "void set(out float a) { a = 1.0; }\nvoid grow(inout float a) { a += 1.0; }\n"


def unwritten_in(folder: Path, body: str) -> list[str]:
    """Return the names in the warnings, and the columns, of a kernel's body."""
    text = f'#pragma kernel(output = "height:r32f")\n{_FUNCTIONS}#define SUM(n) float n; n += 1.0\n'
    (folder / "k.glsl").write_text(f"{text}float kernel(ivec2 texel) {{\n{body}\n}}\n", encoding="utf-8")
    kernel = read_kernel(folder / "k.glsl", folder)
    assert kernel is not None
    assert all(d.severity == "warning" and d.line == 6 for d in unwritten(kernel))
    return [f"{d.message.split()[0]} {d.column}" for d in unwritten(kernel)]


@pytest.mark.parametrize(
    "body",
    [
        "float a; return ^a;",
        "float a; ^a += 1.0; return a;",
        "float a; ^a++; return a;",
        "float a, b = 1.0; return b - ^a;",
        "vec3 a; return ^a.x;",
        "float a[3]; return ^a[1];",
        "float b = 1.0, a; a = ^a + b; return a;",
        "float a; return max(^a, 0.0);",
        "float a; for (int i = 0; i < 3; i++) { ^a += 1.0; a += 2.0; } return a;",
        "for (int a; ^a < 3; a++) {} return 0.0;",
        "float a; if (texel.x > 0) return ^a; a = 1.0; return a;",
        "^SUM(a); return a;",
    ],
)
def test_a_local_read_before_it_is_written_is_a_warning(tmp_path: Path, body: str) -> None:
    assert unwritten_in(tmp_path, body.replace("^", "")) == [f"'a' {body.index('^') + 1}"]


@pytest.mark.parametrize(
    "body",
    [
        "float a; a = 1.0; return a;",
        "float a; set(a); return a;",
        "float a; grow(a); return a;",
        "float a; float b = modf(1.5, a); return a;",
        "float a; if (texel.x > 0) a = 1.0; else a = 2.0; return a;",
        "float a; for (int i = 0; i < 3; i++) { if (i > 0) return a; a = 1.0; } return 0.0;",
        "float a; do { a = 1.0; } while (a < 0.0); return a;",
        "float a[3]; for (int i = 0; i < a.length(); i++) a[i] = 1.0; return a[0];",
        "vec3 a; a.xy = vec2(1.0); a.z = a.x; return a.z;",
        "float a, b; a = b = 1.0; return a + b;",
        "float a; (a) = 1.0; return a;",
        "float a; { float a = 1.0; a += 1.0; } a = 2.0; return a;",
        "vec2 b = vec2(1.0); float x; x = b.x; return x;",
        "float a; if ((a = 2.0) > 1.0) return a; return 0.0;",
        "float a; a = abs(a = 1.0); return a;",
    ],
)
def test_a_local_that_may_be_written_first_is_none(tmp_path: Path, body: str) -> None:
    assert unwritten_in(tmp_path, body) == []


@pytest.mark.slow
def test_no_kernel_of_the_library_reads_before_it_writes() -> None:
    seen = 0
    for path in sorted([*GLSL.rglob("*.glsl"), *GLSL.rglob("*.comp")]):
        with suppress(PlaygroundError):  # files of sketches, which include from their own folder
            if (kernel := read_kernel(path, GLSL)) is not None:
                seen += 1
                assert unwritten(kernel) == (), path
    assert seen > 250


# ── A default that has no effect is reported with what sets the parameter, and where


KERNEL = """#pragma kernel(output = "height:r32f")
uniform float rise = 2.0;  //! slider(0, 10)
uniform int kind = 0;      //! menu("round", "sharp")
uniform float free = 1.0;  //! slider(0, 10)
float kernel(ivec2 texel) { return rise + float(kind) + free; }
"""
SKETCH = """format = 1
size = 9

[[pass]]
name = "first"
use = "./terrain"

[[pass]]
name = "height"
use = "./terrain"
set = { rise = 5, kind = "sharp" }

[[pass]]
name = "nested"
use = "./both"

[pass.set]
two.free = 7
"""
BOTH = """[[pass]]
name = "one"
use = "./terrain"

[[pass]]
name = "two"
use = "./terrain"
set = { rise = 3 }
"""


@pytest.fixture
def shadowed(tmp_path: Path) -> Path:
    (tmp_path / "terrain.glsl").write_text(KERNEL)
    (tmp_path / "both.toml").write_text(BOTH)
    (tmp_path / "sketch.toml").write_text(SKETCH)
    return tmp_path


def listed(result) -> list[str]:
    return [f"{item.path} {item.by.rpartition('/')[2]} {str(item).partition(': ')[2]}" for item in result]


def edited(shadowed: Path, before: str, after: str):
    old = load(shadowed)
    text = (shadowed / "terrain.glsl").read_text()
    (shadowed / "terrain.glsl").write_text(text.replace(before, after))
    return old, load(shadowed)


def test_each_default_that_a_file_sets_over_names_its_line(shadowed):
    sketch = load(shadowed)
    path = shadowed.as_posix()
    assert listed(shadowed_by_files(sketch)) == [
        f"height.rise sketch.toml:11 the default is 2; {path}/sketch.toml:11 sets 5",
        f"height.kind sketch.toml:11 the default is round; {path}/sketch.toml:11 sets sharp",
        f"nested.two.rise both.toml:8 the default is 2; {path}/both.toml:8 sets 3",
        f"nested.two.free sketch.toml:18 the default is 1; {path}/sketch.toml:18 sets 7",
    ]
    warning = shadowed_by_files(sketch)[0].warning
    assert (Path(warning.file).name, warning.line, warning.severity) == ("terrain.glsl", 2, "warning")


def test_user_shipped_or_default_value_is_not_reported_shadowed(shadowed):
    sketch = load(shadowed).with_values({"height.rise": 1.0, "nested.two.free": 2.0})
    assert [item.path for item in shadowed_by_files(sketch)] == ["height.kind", "nested.two.rise"]
    assert shadowed_by_files(load("jacksboro")) == []
    _, now = edited(shadowed, "rise = 2.0", "rise = 5.0")
    assert "height.rise" not in [item.path for item in shadowed_by_files(now)]


def test_an_edit_of_a_default_is_reported_where_it_has_no_effect(shadowed):
    old, now = edited(shadowed, "rise = 2.0", "rise = 9.0")
    assert [item.path for item in newly_shadowed(old, now)] == ["height.rise", "nested.two.rise"]
    assert str(newly_shadowed(old, now)[0]).endswith(
        "the default is 9; " + f"{shadowed}/sketch.toml:11 sets 5"
    )
    assert newly_shadowed(now, now) == []
    by_user = now.with_values({"first.rise": 4.0, "height.rise": 1.0})
    assert [(item.path, item.by.rpartition("/")[2], item.value) for item in newly_shadowed(old, by_user)] == [
        ("first.rise", "the panel", 4.0),
        ("height.rise", "the panel", 1.0),
        ("nested.two.rise", "both.toml:8", 3.0),
    ]
    moving = replace(now, keyframes=(Keyframe(0.0, values=(("first.rise", 1.0),), line=20),))
    assert newly_shadowed(old, moving)[0].by.endswith("sketch.toml:20")


def test_new_default_equal_to_set_value_is_not_shadowed(shadowed):
    old, now = edited(shadowed, "rise = 2.0", "rise = 5.0")
    assert [item.path for item in newly_shadowed(old, now)] == ["nested.two.rise"]
