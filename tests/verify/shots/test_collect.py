"""Which sketches become tests, by which names and markers, and what is reported of those that cannot."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from collections.abc import Callable
from pathlib import Path

import pytest

Run = Callable[..., pytest.RunResult]
Edit = Callable[[str, str, str], None]

ROOT = Path(__file__).resolve().parents[3]
PLUGIN = "playground.verify.shots.plugin"


def collected(result: pytest.RunResult) -> list[str]:
    """Return the node ids that ``--collect-only -q`` lists."""
    return [line for line in result.stdout.lines if "::" in line and "rror" not in line]


def listing(run: Run, *arguments: str) -> list[str]:
    return collected(run("--collect-only", "-q", *arguments))


SLOPE = ["slope.toml::plain", "slope.toml::bright", "slope.toml::references"]


@pytest.mark.slow
def test_a_sketch_on_the_command_line_gives_a_test_for_each_shot(run: Run) -> None:
    assert listing(run, "slope.toml") == SLOPE
    assert listing(run, "slope.toml::bright") == ["slope.toml::bright"]
    assert listing(run, "slope.toml", "-k", "plain or references") == [SLOPE[0], SLOPE[2]]
    assert listing(run, "slope.toml", "--deselect", "slope.toml::plain") == SLOPE[1:]
    assert listing(run, "slope.toml", "-m", "shots") == SLOPE
    assert listing(run, "slope.toml", "-m", "not shots") == []


def test_a_folder_with_a_sketch_is_a_sketch(run: Run) -> None:
    Path("hills").mkdir()
    Path("terrain.glsl").rename("hills/terrain.glsl")
    Path("slope.toml").rename("hills/sketch.toml")
    Path("hills/other.toml").touch()
    names = [f"hills/sketch.toml::{name}" for name in ("plain", "bright", "references")]
    assert listing(run, "hills") == names
    assert listing(run) == []  # it was not named


def test_nothing_changes_for_who_does_not_use_it(run: Run, pytester: pytest.Pytester) -> None:
    """Sketches that are not named, and TOML files that are none, are not looked at."""
    Path("other.toml").write_text("not even = TOML")
    pytester.makepyfile(test_one="def test_one(): pass")
    result = run()
    result.assert_outcomes(passed=1)
    result.stdout.no_fnmatch_line("*shots*")
    assert not Path("shots-report").exists()


@pytest.mark.parametrize(
    ("file", "text"),
    [
        ("pyproject.toml", "[tool.pytest.ini_options]\nshots = ['sketches/*.toml', 'hills']\n"),
        ("pytest.ini", "[pytest]\nshots =\n    sketches/*.toml\n    hills\n"),
    ],
)
def test_the_configuration_names_sketches(run: Run, file: str, text: str) -> None:
    for folder, name in (("sketches", "slope.toml"), ("hills", "sketch.toml")):
        Path(folder).mkdir()
        Path(folder, name).write_text(Path("slope.toml").read_text())
        Path(folder, "terrain.glsl").write_text(Path("terrain.glsl").read_text())
    Path("sketches/notes.txt").touch()
    Path(file).write_text(text)
    names = [
        f"{path}::{name}" for path in ("hills/sketch.toml", "sketches/slope.toml") for name in ("plain",)
    ]
    assert listing(run, "-k", "plain") == names
    assert listing(run, "-k", "plain", "sketches") == names[1:]
    Path("tests").mkdir()  # with testpaths, they are tested as well
    Path("tests/test_one.py").write_text("def test_plain(): pass\n")
    more = "testpaths = ['tests']\n" if file.endswith(".toml") else "testpaths = tests\n"
    Path(file).write_text(text + more)
    assert listing(run, "-k", "plain") == ["tests/test_one.py::test_plain", *names]
    assert listing(run, "-k", "plain", "tests") == ["tests/test_one.py::test_plain"]


def test_a_pattern_that_matches_nothing_is_a_mistake(run: Run) -> None:
    Path("pytest.ini").write_text("[pytest]\nshots = sketchs/*.toml\n")
    result = run()
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["ERROR: shots: no sketch (*) matches 'sketchs/[*].toml' in *"])


@pytest.mark.slow
def test_invalid_sketch_fails_with_message_and_others_run(run: Run, edit: Edit) -> None:
    Path("pyproject.toml").write_text('[project]\nname = "x"\n')
    edit("slope.toml", 'use = "./terrain"', 'use = "./terrian"')
    Path("empty.toml").write_text("format = 1\nsize = 32\n[[pass]]\nname = 'height'\nuse = './terrain'\n")
    result = run("slope.toml", "pyproject.toml", "empty.toml")
    result.assert_outcomes(failed=3, passed=1)
    result.stdout.fnmatch_lines(
        [
            "slope.toml:6: *terrian*did you mean*",
            "pyproject.toml:*",
            "empty.toml: this sketch promises no picture; *",
        ]
    )
    result.stdout.no_fnmatch_line("*Traceback*")
    result = run("slope.toml::plain", "-v")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["slope.toml::plain FAILED*"])


def test_a_shot_may_have_markers(run: Run, edit: Edit) -> None:
    edit("slope.toml", 'name = "bright"', 'name = "bright"\nmarks = ["slow", "other"]')
    Path("pytest.ini").write_text("[pytest]\nmarkers = slow: takes long\naddopts = --strict-markers\n")
    assert listing(run, "slope.toml", "-m", "slow") == SLOPE[1:2]
    assert listing(run, "slope.toml", "-m", "not slow") == [SLOPE[0], SLOPE[2]]
    result = run("slope.toml::bright")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["slope.toml:17: marks: there is no marker 'other'*"])
    edit("slope.toml", '"other"]', "3]")
    result = run("slope.toml")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["slope.toml:19: marks = *3*: expected names of pytest's markers*"])


def test_a_shot_may_be_named_as_the_test_of_references_is(run: Run, edit: Edit) -> None:
    edit("slope.toml", 'name = "bright"', 'name = "references"')
    names = ["slope.toml::plain", "slope.toml::references", "slope.toml::references of all shots"]
    assert listing(run, "slope.toml") == names


@pytest.mark.parametrize("seconds", ["0", "-1", "nan", "inf", "long"])
def test_a_time_limit_is_seconds(run: Run, seconds: str) -> None:
    result = run("slope.toml", f"--shots-timeout={seconds}")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines([f"*--shots-timeout: '{seconds}': expected seconds, more than 0"])


def test_only_what_failed_runs_again(run: Run, edit: Edit, pytester: pytest.Pytester) -> None:
    run("slope.toml", "--shots-update").assert_outcomes(passed=3)
    edit("slope.toml", '"height.gain" = 1.0', '"height.gain" = 0.9')
    with_cache = ("-p", PLUGIN, "slope.toml")
    pytester.runpytest_inprocess(*with_cache).assert_outcomes(passed=2, failed=1)
    result = pytester.runpytest_inprocess(*with_cache, "--lf", "-v")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["slope.toml::bright FAILED*"])


def test_the_entry_point_has_the_modules_name() -> None:
    """Then `-p` and `pytest_plugins` find it registered, where another name would make pytest stop."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text("utf-8"))["project"]
    assert project["entry-points"]["pytest11"] == {PLUGIN: PLUGIN}


FRESH = f"""
import sys, pytest
before = set(sys.modules)
import {PLUGIN}
slow = {{"moderngl", "glcontext", "numpy", "PIL", "imgui_bundle", "glfw", "typer", "rich", "tomllib"}}
new = set(sys.modules) - before
print(sorted(slow & new), sorted(name for name in new if name.startswith("playground")))
"""


def test_being_installed_costs_next_to_nothing() -> None:
    done = subprocess.run([sys.executable, "-c", FRESH], cwd=ROOT, capture_output=True, text=True, check=True)
    small = [
        "playground",
        "playground._version",
        "playground.paths",
        "playground.verify",
        "playground.verify.shots",
    ]
    small += [f"playground.verify.shots.{name}" for name in ("plugin", "plugin_constants")]
    assert done.stdout.strip() == f"[] {small}"
