"""What the results folder keeps: each failure, and nothing that is not so any more."""

from __future__ import annotations

import json
import shutil
import threading
from collections.abc import Callable
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest

from playground.errors import SandboxCrash, SandboxTimeout
from playground.verify.shots.results import place_of

Run = Callable[..., pytest.RunResult]
Edit = Callable[[str, str, str], None]

REPORT = Path("shots-report")
RAMP = "import numpy as np\nRAMP = np.linspace(0, 1, 48).reshape(4, 4, 3)\n"


def words() -> dict[str, str]:
    """Return the word of each record, by folder and shot."""
    return {
        path.relative_to(REPORT).with_suffix("").as_posix(): json.loads(path.read_text())["word"]
        for path in REPORT.glob("*/*.json")
    }


def headline() -> str:
    """Return what the page's title says."""
    return (REPORT / "index.html").read_text().partition("<title>")[2].partition("</title>")[0]


def message_of(name: str) -> str:
    text: str = json.loads((REPORT / f"{name}.json").read_text())["message"]
    return text


@pytest.mark.slow
def test_sketches_of_one_name_do_not_hide_each_others_failures(run: Run, edit: Edit) -> None:
    for folder in ("a", "b"):
        Path(folder).mkdir()
        shutil.copy("slope.toml", folder)
        shutil.copy("terrain.glsl", folder)
    run("a/slope.toml", "b/slope.toml", "--shots-update").assert_outcomes(passed=6)
    edit("a/terrain.glsl", "return gain *", "return 0.5 * gain *")
    for _ in range(2):  # the second run finds the same folders
        run("a/slope.toml", "b/slope.toml").assert_outcomes(passed=4, failed=2)
        (other,) = {name.partition("/")[0] for name in words()} - {"slope"}
        assert other.startswith("slope-")
        wrong, right = "differs", "same"
        assert words() == {
            "slope/plain": wrong,
            "slope/bright": wrong,
            f"{other}/plain": right,
            f"{other}/bright": right,
        }
        assert "2 of 4 shots failed" in headline()
        assert (REPORT / "slope/plain.difference.png").is_file()
    run("b/slope.toml").assert_outcomes(passed=3)
    assert words()["slope/plain"] == wrong, "the other's stays"
    edit("a/terrain.glsl", "return 0.5 * gain *", "return gain *")
    edit("b/terrain.glsl", "return gain *", "return 0.5 * gain *")
    result = run("b/slope.toml::plain")
    result.stdout.fnmatch_lines([f"    actual      */shots-report/{other}/plain.actual.png"])
    shutil.rmtree("a")
    run("b/slope.toml").assert_outcomes(passed=1, failed=2)
    assert words() == {f"{other}/plain": wrong, f"{other}/bright": wrong}
    assert not (REPORT / "slope").exists()


def test_test_files_of_one_name_are_two(run: Run) -> None:
    for folder, gain in (("a", 1.0), ("b", 0.5)):
        Path(folder).mkdir()
        test = f"def test_one(shot): shot.check({gain} * RAMP, 'ramp', by='numpy')\n"
        Path(folder, "test_x.py").write_text(RAMP + test)
    both = ("--import-mode=importlib", "a", "b")
    run(*both, "--shots-update").assert_outcomes(passed=2)
    shutil.copy("b/screenshots/test_x.py/numpy/ramp.png", "a/screenshots/test_x.py/numpy/ramp.png")
    run(*both).assert_outcomes(passed=1, failed=1)
    assert sorted(words().values()) == ["differs", "same"]
    assert words()["test_x.py/ramp"] == "differs"


@pytest.mark.parametrize("first", ["0.5 * ", ""], ids=["the first fails", "the second fails"])
def test_of_two_tests_that_check_one_name_what_failed_stays(run: Run, first: str) -> None:
    second = "" if first else "0.5 * "
    test = RAMP + "def test_{}(shot): shot.check({}RAMP, 'ramp', by='numpy')\n"
    Path("test_x.py").write_text(test.format("a", ""))
    run("--shots-update").assert_outcomes(passed=1)
    Path("test_x.py").write_text(test.format("a", first) + test.format("b", second))
    run().assert_outcomes(passed=1, failed=1)
    assert words() == {"test_x.py/ramp": "differs"}
    Path("test_x.py").write_text(test.format("a", "0.5 * ") + test.format("b", "0.6 * "))
    run().assert_outcomes(failed=2)
    assert message_of("test_x.py/ramp").endswith("; test_x.py::test_a failed as well")
    Path("test_x.py").write_text(test.format("a", "") + test.format("b", ""))
    run().assert_outcomes(passed=2)
    assert words() == {"test_x.py/ramp": "same"}


def test_unloadable_sketch_stays_on_page_until_it_loads(accepted: Run, edit: Edit) -> None:
    accepted("slope.toml", "--shots-report")
    assert "All 2 shots passed" in headline()
    edit("slope.toml", 'use = "./terrain"', 'use = "./terrian"')
    accepted("slope.toml").assert_outcomes(failed=1)
    assert words() == {"slope/plain": "same", "slope/bright": "same", "slope/sketch": "error"}
    assert "1 of 3 shots failed" in headline() and "terrian" in message_of("slope/sketch")
    edit("slope.toml", 'use = "./terrian"', 'use = "./terrain"')
    accepted("slope.toml").assert_outcomes(passed=3)
    assert words() == {"slope/plain": "same", "slope/bright": "same"}
    assert "All 2 shots passed" in headline()


def test_a_reference_in_vain_is_on_the_page_until_it_is_gone(accepted: Run) -> None:
    old = Path("screenshots/slope/llvmpipe/old.png")
    shutil.copy(old.with_name("plain.png"), old)
    accepted("slope.toml").assert_outcomes(passed=2, failed=1)
    assert words()["slope/references"] == "error" and "1 of 3 shots failed" in headline()
    assert "remove" in message_of("slope/references")
    old.unlink()
    accepted("slope.toml").assert_outcomes(passed=3)
    assert "slope/references" not in words() and "All 2 shots passed" in headline()


def test_an_unknown_marker_is_on_the_page(accepted: Run, edit: Edit) -> None:
    edit("slope.toml", 'name = "bright"', 'name = "bright"\nmarks = ["other"]')
    accepted("slope.toml", "--strict-markers").assert_outcomes(passed=2, failed=1)
    assert words()["slope/bright"] == "error" and "1 of 2 shots failed" in headline()


def test_a_renderer_that_is_missing_in_ci_is_on_the_page(
    accepted: Run, monkeypatch: pytest.MonkeyPatch
) -> None:
    Path("test_one.py").write_text("def test_one(shot): shot.render('slope.toml')\n")
    options = ("slope.toml", "test_one.py", "--shots-renderer=nvidia-h200")
    result = accepted(*options)
    result.assert_outcomes(skipped=3, passed=1)
    result.stdout.fnmatch_lines(
        ["*= shots =*", "3 shots were not compared: the expected renderer is missing: *"]
    )
    monkeypatch.setenv("CI", "true")
    accepted(*options).assert_outcomes(failed=3, passed=1)
    assert words() == {"slope/plain": "error", "slope/bright": "error", "test_one.py/one": "error"}
    assert "All 3 shots failed" in headline() or "3 of 3 shots failed" in headline()


RENDERS = """
import pytest
from playground.errors import SandboxCrash

def test_one(shot):
    shot.check(shot.render("slope.toml", shot="bright"), "one")

def test_meant(shot):
    with pytest.raises(SandboxCrash, match="SIGSEGV"):
        shot.render("slope.toml", shot="plain")
"""


@pytest.mark.parametrize(
    ("end", "word"),
    [
        (SandboxCrash("drawing it crashed: by SIGSEGV\n    | nir: wrong"), "crash"),
        (SandboxTimeout("took 9 s"), "hang"),
    ],
    ids=["crash", "hang"],
)
def test_render_exception_is_reported_by_its_word_and_on_page(
    run: Run, ends: dict[str, Exception], end: Exception, word: str
) -> None:
    Path("test_x.py").write_text(RENDERS)
    run("--shots-update", "-k", "one").assert_outcomes(passed=1, deselected=1)
    ends["bright"], ends["plain"] = end, SandboxCrash("drawing it crashed: by SIGSEGV")
    result = run("--shots-report")
    result.assert_outcomes(passed=1, failed=1)
    message = str(end).partition("\n")[0]
    result.stdout.fnmatch_lines([f"E *Sandbox*: {word}: {message}", "test_x.py:6: *"])
    assert "playground/verify/shots" not in result.stdout.str().replace("shots-report", "").replace("\\", "/")
    assert words() == {"test_x.py/one": word}, "and not what an earlier run has found"
    assert message_of("test_x.py/one") == message
    ends.clear()
    run("-k", "one").assert_outcomes(passed=1, deselected=1)
    assert words() == {"test_x.py/one": "same"} and "1 shot passed" in headline()


def test_sketch_error_in_render_omits_internal_frames(run: Run, edit: Edit) -> None:
    Path("test_x.py").write_text(RENDERS)
    edit("slope.toml", 'use = "./terrain"', 'use = "./terrian"')
    result = run("-k", "one")
    result.assert_outcomes(failed=1, deselected=1)
    result.stdout.fnmatch_lines(["E *SketchError: slope.toml:6: *terrian*"])
    assert "/playground/" not in result.stdout.str()
    assert words() == {"test_x.py/one": "error"} and "1 of 1 shot failed" in headline()


def test_records_of_what_is_gone_go(accepted: Run, edit: Edit) -> None:
    shutil.copy("slope.toml", "other.toml")
    Path("test_x.py").write_text(RAMP + "def test_one(shot): shot.check(RAMP, 'ramp', by='numpy')\n")
    accepted("slope.toml", "other.toml", "test_x.py", "--shots-update").assert_outcomes(passed=7)
    everything = {"slope/plain", "slope/bright", "other/plain", "other/bright", "test_x.py/ramp"}
    assert set(words()) == everything
    edit("slope.toml", 'name = "bright"', 'name = "brighter"')
    accepted("slope.toml::plain").assert_outcomes(passed=1)
    assert set(words()) == everything - {"slope/bright"}
    Path("other.toml").unlink()
    edit("test_x.py", "'ramp'", "'slant'")
    Path("screenshots/test_x.py/numpy/ramp.png").rename("screenshots/test_x.py/numpy/slant.png")
    accepted("slope.toml::plain", "test_x.py").assert_outcomes(passed=2)
    assert set(words()) == {"slope/plain", "test_x.py/slant"}


def test_references_of_a_test_file_in_vain_are_on_the_page(run: Run) -> None:
    Path("test_x.py").write_text(RAMP + "def test_one(shot): shot.check(RAMP, 'ramp', by='numpy')\n")
    run("--shots-update").assert_outcomes(passed=1)
    old = Path("screenshots/test_x.py/numpy/old.png")
    shutil.copy(old.with_name("ramp.png"), old)
    run().assert_outcomes(passed=1, failed=1)
    assert words() == {"test_x.py/ramp": "same", "test_x.py/references": "error"}
    assert "1 of 2 shots failed" in headline() and "earlier run" not in (REPORT / "index.html").read_text()
    old.unlink()
    run().assert_outcomes(passed=1)
    assert words() == {"test_x.py/ramp": "same"} and "1 shot passed" in headline()


def test_where_results_cannot_be_recorded_one_sentence_says_so(accepted: Run, edit: Edit) -> None:
    Path("taken").write_text("mine")
    options = ("slope.toml", "--shots-output", "taken")
    message = "no results are recorded: *taken*; --shots-output names another folder"
    result = accepted(*options)
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(["*= shots =*", message])
    assert result.stdout.str().count("no results are recorded") == 1
    edit("terrain.glsl", "return gain *", "return 0.5 * gain *")
    result = accepted(*options)
    result.assert_outcomes(passed=1, failed=2)
    result.stdout.fnmatch_lines(["slope/plain: differs: *", f"    {message}", "slope/bright: differs: *"])
    edit("terrain.glsl", "float(size.x)", "float(siez.x)")
    result = accepted(*options)
    result.stdout.fnmatch_lines(["slope/plain: *terrain.glsl:7:*siez*", f"    {message}"])
    result.stdout.no_fnmatch_line("*Traceback*")
    assert Path("taken").read_text() == "mine"


@pytest.mark.slow
def test_accept_command_names_file_relative_to_subfolder(
    accepted: Run, edit: Edit, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Pytest's own ids begin at its root folder."""
    Path("pytest.ini").write_text("[pytest]\n")
    Path("sub").mkdir()
    for file in ("slope.toml", "terrain.glsl"):
        shutil.copy(file, "sub")
    whole = str(Path("slope.toml").absolute())
    monkeypatch.chdir("sub")
    for value, named in (("slope.toml", "slope.toml"), ("../slope.toml", whole)):
        if value != named:
            edit("../terrain.glsl", "return gain *", "return 0.5 * gain *")
        result = accepted(value, "-k", "plain")
        result.assert_outcomes(failed=1, deselected=2)
        result.stdout.fnmatch_lines([f"    accept it   pytest --shots-update {named}::plain"])
        accepted("--shots-update", f"{named}::plain").assert_outcomes(passed=1)
        accepted(value, "-k", "plain").assert_outcomes(passed=1, deselected=2)


def test_concurrent_sketches_of_one_name_get_distinct_folders(tmp_path: Path) -> None:
    homes = [tmp_path / name / "screenshots" for name in "abcdefgh"]
    start = threading.Barrier(len(homes))

    def ask(home: Path) -> str:
        start.wait(60)
        return place_of(tmp_path / "out", "hills", home)

    with ThreadPoolExecutor(len(homes)) as pool:
        places = list(pool.map(ask, homes))
    assert len(set(places)) == len(homes) and "hills" in places
    assert [place_of(tmp_path / "out", "hills", home) for home in homes] == places
    (tmp_path / "out").rename(tmp_path / "moved")  # with the folders next to it, it may be moved
    assert place_of(tmp_path / "moved", "hills", homes[0]) == places[0]
