"""A failing shot names the first line whose value is another than in its reference's run."""

from __future__ import annotations

import html
import os
import subprocess
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path

import pytest

from playground.verify.shots.results import read_results

pytestmark = pytest.mark.slow

Run = Callable[..., pytest.RunResult]
Edit = Callable[[str, str, str], None]

HILLS = """// hills.glsl -- waves, then a height of their squares.
#pragma kernel(output = "hills:r32f", repeat = "count")
#include "wave.glsl"

uniform int count = 5;      //! slider(1, 9)

float kernel(ivec2 texel) {
    float before = previous(texel);
    float step = float(iteration + 1);
    if (step > 2.5) step *= 1.0;
    return before + 0.02 * step * wave(texel.x);
}
"""
WAVE = """// wave.glsl -- a wave along x.
float wave(int x) {
    float phase = 0.3 * float(x);
    return sin(phase) * 0.5 + 0.5;
}
"""
SKETCH = """format = 1
size = 32

[[pass]]
name = "hills"
use = "./hills"

[[pass]]
name = "height"
use = "./terrain"
inputs = { hills = "hills" }

[view]
use = "view/map"
inputs = { shown = "height" }
set = { channel = "red" }

[[shot]]
name = "plain"
size = [32, 32]
"""
TERRAIN = """// terrain.glsl -- the hills, lighter.
#pragma kernel(output = "height:r32f")

uniform sampler2D hills;  //! input
uniform float gain = 0.5;  //! slider(0, 1)

float kernel(ivec2 texel) {
    float hill = texelFetch(hills, texel, 0).r;
    float lighter = hill + 0.25;
    return gain * lighter;
}
"""


def git(*arguments: str) -> str:
    identity = {f"GIT_{who}_{what}": "a@b" for who in ("AUTHOR", "COMMITTER") for what in ("NAME", "EMAIL")}
    done = subprocess.run(
        ["git", *arguments], check=True, capture_output=True, text=True, env=os.environ | identity
    )
    return done.stdout.strip()


@pytest.fixture
def committed(run: Run, tmp_path: Path) -> Run:
    """Give what runs pytest on a sketch that is committed with its reference."""
    for name, text in {
        "hills.glsl": HILLS,
        "wave.glsl": WAVE,
        "terrain.glsl": TERRAIN,
        "slope.toml": SKETCH,
    }.items():
        Path(name).write_text(text)
    run("slope.toml", "--shots-update").assert_outcomes(passed=2)
    git("init", "-q")
    git("add", ".")
    git("commit", "-qm", "a")
    return run


def traced(run: Run, *options: str) -> tuple[str, ...]:
    """Return what a failing run says of the first value that differs."""
    run("slope.toml", *options).assert_outcomes(failed=1, passed=1)
    (record,) = [record for record in read_results(Path("shots-report")) if record.shot == "plain"]
    assert not record.ok
    return record.traced


def test_an_edited_line_is_named_with_both_values(committed: Run, edit: Edit) -> None:
    edit("terrain.glsl", "hill + 0.25", "hill + 0.35")
    first, now, before, run = traced(committed, "--junitxml=found.xml")
    assert first.startswith("terrain.glsl:9: lighter = ")
    assert "pass height, texel (" in first
    assert "hill + 0.35" in now and "hill + 0.25" in before
    assert git("rev-parse", "--short", "HEAD") in run and "hash" in run
    names = [
        each for each in ElementTree.parse("found.xml").iter("property") if each.get("name") == "shot.trace"
    ]
    assert [str(each.get("value")).startswith(first) for each in names] == [True]
    assert first in html.unescape(Path("shots-report/index.html").read_text())


def test_a_repeat_is_traced_where_it_first_differs(committed: Run, edit: Edit) -> None:
    edit("hills.glsl", "step *= 1.0", "step *= 1.1")
    first, *_ = traced(committed)
    assert first.startswith("hills.glsl:10: step = 3.3, in the reference's run 3 ")
    assert "iteration 2" in first


def test_a_line_of_an_included_file_is_named(committed: Run, edit: Edit) -> None:
    edit("wave.glsl", "0.3 * float(x)", "0.31 * float(x)")
    first, *_ = traced(committed)
    assert first.startswith("wave.glsl:3: phase = ")
    assert "iteration 0" in first


def test_a_value_of_the_sketch_is_named_where_it_is_read(committed: Run, edit: Edit) -> None:
    edit("slope.toml", 'inputs = { hills = "hills" }', 'inputs = { hills = "hills" }\nset = { gain = 0.6 }')
    first, *more = traced(committed)
    assert "terrain.glsl:10: " in first  # the first line that names gain
    assert any("gain = 0.6" in line and "0.5" in line for line in more)


def test_texts_of_the_last_commit_stand_in_and_are_said_to(committed: Run, edit: Edit) -> None:
    """The reference was drawn by texts that were never committed."""
    edit("terrain.glsl", "hill + 0.25", "hill + 0.32")
    committed("slope.toml", "--shots-update").assert_outcomes(passed=2)
    edit("terrain.glsl", "hill + 0.32", "hill + 0.4")
    *_, run = traced(committed)
    assert "not known" in run and git("rev-parse", "--short", "HEAD") in run


def test_a_texture_that_has_no_other_text_is_no_trace(committed: Run) -> None:
    """Only the picture was changed: neither text nor value is another one."""
    from playground.data.image_files import read_png, write_png

    path = Path("screenshots/slope/llvmpipe/plain.png")
    pixels, texts = read_png(path)
    pixels[4, 5, :3] ^= 64
    write_png(path, pixels, text=texts)
    git("commit", "-qam", "b")
    (said,) = traced(committed)
    assert said.startswith("no trace: ") and "texts and values are those" in said
    write_png(path, pixels, text=texts | {"version": "4.5 Mesa 1.2.3"})
    git("commit", "-qam", "c")
    (said,) = traced(committed)
    assert "another renderer" in said


def test_without_git_the_reason_is_said(accepted: Run, edit: Edit) -> None:
    edit("terrain.glsl", "return gain *", "return 0.5 * gain *")
    result = accepted("slope.toml")
    result.assert_outcomes(failed=2, passed=1)
    result.stdout.fnmatch_lines(["*no trace: *no repository of git*"])


def test_the_first_line_that_is_no_number_is_named(committed: Run, edit: Edit) -> None:
    edit("terrain.glsl", "float lighter = hill + 0.25;", "float lighter = hill + sqrt(0.1 - hill);")
    first, now = traced(committed)
    assert first.startswith("terrain.glsl:9: lighter = NaN") and "sqrt(0.1 - hill)" in now
