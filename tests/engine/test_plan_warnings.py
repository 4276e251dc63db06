"""What is drawn though something is amiss is reported once: to a program, at the terminal, in a check."""

from __future__ import annotations

import warnings
from functools import partial
from pathlib import Path

import numpy as np
import pytest
import tifffile

import playground
from playground import cli
from playground.engine import sandbox as sandbox_module
from playground.engine.sandbox import Sandbox
from playground.studio.problems.problems import Warnings
from playground.verify.check import check_file

from ..loading import load
from ..sketch_texts import map_of, passes

SKETCH = (
    "format = 1\nsize = 9\nextent = 900\nrelief = 70\n"
    + passes(height=("generation/heightmap", 'set = { elevation = "two.tif" }'), other="./mine")
    + map_of("height")
)
KERNEL = """#pragma kernel(output = "height:r32f")
uniform float idle = 1.0;  //! slider(0, 2)
#line 7
float kernel(ivec2 texel) { return 1.0; }
"""
SECOND = "two.tif: the first of 2 pictures was read"


@pytest.fixture
def sketch(folder, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A sketch of an elevation file of two pictures, and a kernel with an idle parameter."""
    terrain = np.arange(72, dtype=np.float32).reshape(8, 9)
    for _ in range(2):
        tifffile.imwrite(folder.path / "two.tif", terrain, append=True)
    folder.write("mine.glsl", KERNEL)
    path = folder.write("sketch.toml", SKETCH)
    monkeypatch.chdir(folder.path)
    monkeypatch.setattr(sandbox_module, "Sandbox", partial(sandbox_module.Sandbox, limit_seconds=120.0))
    return path


def test_an_engine_reports_each_once(any_engine, sketch):
    reports: list[tuple[str, str]] = []
    any_engine.warnings.report = lambda result: reports.append((result.location, result.message))
    for size in ((8, 8), (9, 9)):
        any_engine.render(load(sketch), size=size)
    report = next(position for position, message in reports if message == SECOND)
    assert len(reports) == 2 and report.endswith("sketch.toml:5")
    assert sum("#line is left out" in message for _, message in reports) == 1


def test_steps_past_end_of_time_repeat_are_reported_once(any_engine, folder):
    """One whose number stays is refused; this one may grow."""
    reports: list[str] = []
    any_engine.warnings.report = lambda result: reports.append(f"{result.severity}: {result.message}")
    text = '#pragma kernel(output = "a:r32f", repeat = "floor(2 * time)")\n'
    text += "float kernel(ivec2 texel) { return previous(texel) + 1.0; }\n"
    for time, expected in ((1.0, 2), (1.5, 3), (6.0, 5)):
        assert any_engine.read(folder.one(text), "a", time=time, steps={"a": 5})[0, 0] == expected
    assert reports == ["warning: steps: 'a' stops after 5 steps, but at 1 s it has 2"]


def test_a_program_gets_them_as_python_s_own_warnings(sketch):
    with playground.headless() as engine, pytest.warns(playground.PlaygroundWarning) as caught:
        engine.render(sketch, size=(8, 8))
        engine.render(sketch, size=(9, 9))
    assert sorted(SECOND in str(w.message) for w in caught) == [False, True]


def test_render_and_export_print_each_once(sketch, capsys):
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        for command in (["render", ".", "--size", "16x9", "-o", "a.png"], ["export", ".", "--to", "b.npy"]):
            assert cli.main(command) == 0
            printed = capsys.readouterr().err
            assert printed.count(SECOND) == 1, printed
            assert f"warning: sketch.toml:5: {SECOND}" in printed


@pytest.mark.slow
def test_check_shows_them_and_fails_for_none(sketch, capsys):
    assert cli.main(["check", "."]) == 0
    out = capsys.readouterr().out
    assert out.count(f"warning: sketch.toml:5: {SECOND}") == 1
    assert out.count("nothing reads 'idle'") == 1  # of the kernel, and again of the sketch
    assert "2 files checked, none failed, 3 warnings" in out
    with Sandbox() as made:
        report = check_file(sketch, made).as_json()
    assert report["ok"] and SECOND in [w["message"] for w in report["warnings"]]


def test_the_window_lists_them(any_engine, sketch):
    known_names = Warnings(lambda kernel: ())
    loaded = load(sketch)
    any_engine.render(loaded, size=(8, 8))
    assert [w.message for w in known_names.of(loaded, any_engine.record.plan)] == [SECOND]
    while known_names.waiting:
        known_names.look()
    assert [w.line for w in known_names.of(loaded, any_engine.record.plan)] == [2, 3, 5]


def test_file_removed_while_shown_gives_no_warning(any_engine, sketch):
    loaded = load(sketch)
    any_engine.render(loaded, size=(8, 8))
    (sketch.parent / "two.tif").unlink()
    assert Warnings(lambda kernel: ()).of(loaded, any_engine.record.plan) == []


@pytest.mark.slow
def test_a_hidden_default_is_reported_by_render_and_check(folder, monkeypatch, capsys):
    folder.one(
        KERNEL.replace("return 1.0", "return idle").replace("#line 7\n", ""), more="set = { idle = 2.0 }"
    )
    monkeypatch.chdir(folder.path)
    printed = "the default is 1; sketch.toml:6 sets 2"
    assert cli.main(["render", ".", "--size", "16x9", "-o", "a.png"]) == 0
    assert capsys.readouterr().err.splitlines() == [f"a.idle: {printed}"]
    assert cli.main(["render", ".", "--size", "16x9", "-o", "a.png", "--set", "a.idle=0.5"]) == 0
    assert "default" not in capsys.readouterr().err
    assert cli.main(["check", "sketch.toml"]) == 0
    assert f"warning: one.glsl:2: {printed} in pass 'a'" in capsys.readouterr().out


def test_shot_stopping_beyond_repeat_is_refused_at_its_line(folder, monkeypatch, capsys):
    more = '[[shot]]\nname = "end"\nsteps = { a = 99 }\n'
    folder.one(KERNEL.replace('32f")', '32f", repeat = "5")').replace("#line 7\n", ""), more=more)
    monkeypatch.chdir(folder.path)
    assert cli.main(["render", ".", "--shot", "end", "-o", "a.png"]) == 2
    printed = "error: sketch.toml:6: shot 'end': steps: 'a' stops after 99 steps, but it has 5 in all\n"
    assert capsys.readouterr().err == printed


@pytest.mark.parametrize(
    ("use", "values", "message"),
    [
        ("layered_noise", "frequency = 1", "the same one interval"),
        ("layered_noise", "frequency = 40, octaves = 1", "than there are gaps between texels"),
        ("layered_noise", "frequency = 4, octaves = 5", "as many intervals as there are gaps"),
        ("layered_noise", "frequency = 4, octaves = 3", None),
        ("mixed_tiled", 'frequency = 32, tiles = 32, seams = "left"', "a tile is one texel wide"),
        ("endless/detail", "frequency = 9, octaves = 2", "less than two texels a cell"),
        ("endless/detail", "frequency = 8, octaves = 2", None),
        ("endless/shape", "hills = 7, layers = 3", "all have hills of two texels"),
        ("endless/shape", "hills = 8, layers = 3", None),
        ("gradient_noise", "frequency = 17.0", "is lowered until it has two"),
        ("gradient_noise", "frequency = 16.0", None),
        ("fbm", "frequency = 17.0", "is lowered until it has two"),
    ],
)
def test_parameters_that_make_no_sense_together_are_warned_of(any_engine, folder, use, values, message):
    """Each by its kernel's own condition, whichever of its fast variants runs."""
    names: list[str] = []
    any_engine.warnings.report = lambda warning: names.append(warning.message)
    sketch = folder.sketch(
        f'[[pass]]\nname = "a"\nuse = "generation/{use}"\nset = {{ {values} }}\n', size="size = 33"
    )
    any_engine.read(sketch, "a")
    any_engine.read(sketch, "a")
    assert len(names) == (message is not None)
    assert all(each.startswith("pass 'a': ") and str(message) in each for each in names)
