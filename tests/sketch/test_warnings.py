"""Parameters that nothing reads are found, and only those."""

from __future__ import annotations

from pathlib import Path

import pytest

from playground.errors import PlaygroundError
from playground.paths import GLSL
from playground.sketch.techniques import read_kernel
from playground.sketch.warnings import unread


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


def test_a_name_that_only_a_comment_or_a_longer_name_has_is_not_read(tmp_path: Path) -> None:
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
            assert unread(kernel) == (), path
    assert seen > 50


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
