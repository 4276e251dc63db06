"""The plugin on a tiny sketch of a user's own: what passes, what fails, and in which words."""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.gpu.context import ContextInfo
from playground.images.files import read_png
from playground.shots.references import write_reference
from playground.sketch.load import load

pytestmark = pytest.mark.skipif(
    not sys.platform.startswith("linux"),
    reason="the reference renderer, Mesa's llvmpipe, is chosen by name on Linux",
)

KERNEL = """// land.glsl -- a slope.
#pragma kernel(output = "height:r32f")

uniform float gain = 0.5;  //! slider(0, 1) How bright it is in the east

float kernel(ivec2 texel) {
    return gain * float(texel.x) / float(size.x);
}
"""

SKETCH = """format = 1
size = 32

[[pass]]
name = "height"
use = "./land"

[view]
use = "view/map"
inputs = { shown = "height" }
set = { channel = "red" }

[[shot]]
name = "plain"
size = [32, 32]

[[shot]]
name = "bright"
size = [40, 32]
set = { "height.gain" = 1.0 }
"""

TESTS = """
import pytest
from playground.shots.suite import shots_of
from playground.sketch.load import load

SKETCHES = [load("slope.toml")]

@pytest.mark.parametrize("case", shots_of(SKETCHES), ids=str)
def test_shot(case, shots):
    shots.check(case)

def test_no_stale(shots):
    shots.check_no_stale(SKETCHES)
"""

Run = Callable[..., pytest.RunResult]


@pytest.fixture
def run(pytester: pytest.Pytester, monkeypatch: pytest.MonkeyPatch) -> Run:
    """Give what runs pytest in a folder with the tiny sketch and its tests."""
    for variable in ("CI", "GALLIUM_DRIVER", "PYTEST_ADDOPTS"):
        monkeypatch.delenv(variable, raising=False)
    Path("land.glsl").write_text(KERNEL)
    Path("slope.toml").write_text(SKETCH)
    pytester.makepyfile(test_slope=TESTS)
    fixed = ("-p", "playground.shots.plugin", "-p", "no:cacheprovider", "-W", "error", "-ra")
    return lambda *arguments: pytester.runpytest_inprocess(*fixed, *arguments)


@pytest.fixture
def accepted(run: Run) -> Run:
    """Give the same, with references that match."""
    run("--shots-update").assert_outcomes(passed=3)
    return run


def references() -> list[str]:
    return sorted(path.as_posix() for path in Path("screenshots").rglob("*"))


def put_at(output: str, word: str) -> Path:
    """Return the file that a failure names."""
    found = re.search(rf"^    {word} +(\S.*)$", output, re.MULTILINE)
    assert found, output
    return Path(found[1])


def edit(file: str, old: str, new: str) -> None:
    text = Path(file).read_text()
    assert old in text
    Path(file).write_text(text.replace(old, new))


def test_a_missing_reference_fails_and_shows_what_it_would_be(run: Run) -> None:
    result = run()
    result.assert_outcomes(failed=2, passed=1)
    result.stdout.fnmatch_lines(
        ["slope/plain: missing: *", "    reference * screenshots/slope/llvmpipe/plain.png"]
    )
    pixels, _ = read_png(put_at(result.stdout.str(), "actual"))
    assert pixels.shape == (32, 32, 4)
    result.stdout.fnmatch_lines(["    accept it *--shots-update 'test_slope.py::test_shot?slope/plain?'"])


def test_a_failure_leaves_nothing_in_the_tree(run: Run) -> None:
    before = set(Path().rglob("*"))
    run().assert_outcomes(failed=2, passed=1)
    assert {path for path in set(Path().rglob("*")) - before if "__pycache__" not in path.parts} == set()


def test_update_writes_and_says_so_and_then_all_pass(run: Run) -> None:
    result = run("--shots-update")
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(
        [
            "*= shots =*",
            "wrote screenshots/slope/llvmpipe/plain.png  (missing: *",
            "wrote screenshots/slope/llvmpipe/bright.png  (missing: *",
        ]
    )
    assert [name for name in references() if name.endswith(".png")] == [
        "screenshots/slope/llvmpipe/bright.png",
        "screenshots/slope/llvmpipe/plain.png",
    ]
    result = run()
    result.assert_outcomes(passed=3)
    result.stdout.no_fnmatch_line("*= shots =*")


def test_update_leaves_what_matches_alone(accepted: Run) -> None:
    edit("slope.toml", '"height.gain" = 1.0', '"height.gain" = 0.9')
    kept = Path("screenshots/slope/llvmpipe/plain.png")
    before = kept.stat().st_mtime_ns
    result = accepted("--shots-update")
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(["wrote screenshots/slope/llvmpipe/bright.png  (differs: *"])
    result.stdout.no_fnmatch_line("*plain.png*")
    assert kept.stat().st_mtime_ns == before


@pytest.mark.parametrize("factor", ["0.95", "1.05"], ids=["darker", "brighter"])
def test_a_visible_change_of_the_kernel_fails_with_everything_to_see_it_by(
    accepted: Run, factor: str
) -> None:
    edit("land.glsl", "return gain *", f"return {factor} * gain *")
    result = accepted("-k", "plain")
    result.assert_outcomes(failed=1, deselected=2)
    output = result.stdout.str()
    actual, expected, shown = (
        read_png(put_at(output, word))[0] for word in ("actual", "expected", "difference")
    )
    signed = actual.astype(int) - expected.astype(int)
    assert (signed <= 0).all() if factor < "1" else (signed >= 0).all()
    most, over = np.abs(signed).max(), np.count_nonzero(np.abs(signed).max(axis=2) > 1)
    assert most in (6, 7)  # the brightest is 0.5 * 31/32 * 255 = 123.5; 5 % of that are 6.2 levels
    said = rf"slope/plain: differs: max difference {most} of 255, at x = \d+, y = 0 from the top left"
    assert re.search(said, output)
    assert f"; {over} of 1024 pixels ({100 * over / 1024:.3g} %) over 1" in output
    np.testing.assert_array_equal(shown[..., :3], 16 * np.abs(signed[..., :3]))
    np.testing.assert_array_equal(expected, read_png("screenshots/slope/llvmpipe/plain.png")[0])


def test_a_change_nobody_can_see_passes(accepted: Run) -> None:
    edit("land.glsl", "return gain *", "// the east is up\n    return 0.9999 * gain *")
    accepted().assert_outcomes(passed=3)


def test_one_shot_fails_and_the_other_passes(accepted: Run) -> None:
    edit("slope.toml", '"height.gain" = 1.0', '"height.gain" = 0.9')
    result = accepted()
    result.assert_outcomes(failed=1, passed=2)
    result.stdout.fnmatch_lines(["slope/bright: differs: max difference 25 of 255, *"])


def test_another_size_fails_in_its_own_word(accepted: Run) -> None:
    edit("slope.toml", "size = [40, 32]", "size = [40, 31]")
    result = accepted("-k", "bright")
    result.assert_outcomes(failed=1, deselected=2)
    result.stdout.fnmatch_lines(["slope/bright: size: 40 × 31 pixels where 40 × 32 were expected"])


def test_any_further_reference_may_match(accepted: Run) -> None:
    folder = Path("screenshots/slope/llvmpipe")
    edit("land.glsl", "return gain *", "return 0.5 * gain *")
    shutil.copy(folder / "plain.png", folder / "plain.2.png")
    accepted("-k", "plain", "--shots-update").assert_outcomes(passed=1, deselected=2)
    shutil.copy(folder / "plain.png", folder / "plain.3.png")
    shutil.copy(folder / "bright.png", folder / "plain.png")
    accepted("-k", "plain").assert_outcomes(passed=1, deselected=2)
    (folder / "plain.3.png").unlink()
    accepted("-k", "plain").assert_outcomes(failed=1, deselected=2)


def test_an_update_says_that_it_removed_further_references(accepted: Run) -> None:
    folder = Path("screenshots/slope/llvmpipe")
    shutil.copy(folder / "plain.png", folder / "plain.2.png")
    edit("land.glsl", "return gain *", "return 0.5 * gain *")
    result = accepted("-k", "plain", "--shots-update")
    result.stdout.fnmatch_lines(["wrote *plain.png *", "removed screenshots/slope/llvmpipe/plain.2.png *"])
    edit("land.glsl", "return 0.5 * gain *", "return gain *")
    accepted("-k", "plain").assert_outcomes(failed=1, deselected=2)


def test_a_blank_picture_fails_and_is_never_written(accepted: Run) -> None:
    edit("land.glsl", "return gain *", "return 0.0 *")
    before = Path("screenshots/slope/llvmpipe/plain.png").read_bytes()
    for arguments in ((), ("--shots-update",)):
        result = accepted(*arguments)
        result.assert_outcomes(failed=2, passed=1)
        result.stdout.fnmatch_lines(["slope/plain: blank: all 32 × 32 pixels are (0, 0, 0, 255)"])
        result.stdout.no_fnmatch_line("*accept it*")
    assert Path("screenshots/slope/llvmpipe/plain.png").read_bytes() == before


def test_a_reference_that_cannot_be_read_fails_until_it_is_written_anew(accepted: Run) -> None:
    path = Path("screenshots/slope/llvmpipe/plain.png")
    path.write_bytes(path.read_bytes()[:60])
    result = accepted("-k", "plain")
    result.assert_outcomes(failed=1, deselected=2)
    result.stdout.fnmatch_lines(["slope/plain: *plain.png: the file is damaged or cut short*"])
    accepted("-k", "plain", "--shots-update").assert_outcomes(passed=1, deselected=2)
    accepted().assert_outcomes(passed=3)


def test_a_reference_that_no_shot_uses_fails(accepted: Run) -> None:
    edit("slope.toml", 'name = "bright"', 'name = "brighter"')
    result = accepted("--shots-update")
    result.assert_outcomes(failed=1, passed=2)
    result.stdout.fnmatch_lines(
        ["no shot uses 1 reference; remove:", "    screenshots/slope/llvmpipe/bright.png"]
    )
    Path("screenshots/slope/llvmpipe/bright.png").unlink()
    accepted().assert_outcomes(passed=3)


def test_pictures_go_where_they_are_wanted(accepted: Run) -> None:
    edit("land.glsl", "return gain *", "return 0.5 * gain *")
    result = accepted("--shots-output", "out")
    result.assert_outcomes(failed=2, passed=1)
    assert put_at(result.stdout.str(), "actual") == Path("out/slope/plain.actual.png").absolute()
    assert sorted(path.name for path in Path("out/slope").iterdir()) == [
        f"{shot}.{word}.png"
        for shot in ("bright", "plain")
        for word in ("actual", "difference", "expected", "flip")
    ]


def test_a_mistake_in_a_kernel_fails_with_its_place(accepted: Run) -> None:
    edit("land.glsl", "float(size.x)", "float(siez.x)")
    result = accepted("-k", "plain")
    result.assert_outcomes(failed=1, deselected=2)
    result.stdout.fnmatch_lines(["slope/plain: land.glsl:7:*siez*"])


def test_a_reference_of_another_build_is_named_when_it_differs(accepted: Run) -> None:
    path = Path("screenshots/slope/llvmpipe/plain.png")
    before, _ = read_png(path)
    other = ContextInfo(450, "llvmpipe (LLVM 19.1.7, 256 bits)", "Mesa", "4.5 Mesa 25.0.7", 4)
    write_reference(load("slope.toml"), "plain", other, before)
    accepted("-k", "plain").assert_outcomes(passed=1, deselected=2)
    write_reference(load("slope.toml"), "plain", replace(other), 255 - before)
    result = accepted("-k", "plain")
    result.assert_outcomes(failed=1, deselected=2)
    result.stdout.fnmatch_lines(["    reference   by llvmpipe (LLVM 19.1.7, 256 bits), 4.5 Mesa 25.0.7"])


@pytest.mark.parametrize("driver", ["softpipe", "no-such-driver"])
def test_another_renderer_is_a_failure_in_ci_and_a_skip_with_its_reason_elsewhere(
    accepted: Run, monkeypatch: pytest.MonkeyPatch, driver: str
) -> None:
    before = references()
    monkeypatch.setenv("GALLIUM_DRIVER", driver)
    result = accepted()
    result.assert_outcomes(skipped=2, passed=1)
    result.stdout.fnmatch_lines(
        ["SKIPPED *the reference renderer is missing: shots are compared on llvmpipe*"]
    )
    monkeypatch.setenv("CI", "true")
    for arguments in ((), ("--shots-update",)):
        result = accepted(*arguments)
        result.assert_outcomes(failed=2, passed=1)
        result.stdout.fnmatch_lines(["the reference renderer is missing: shots are compared on llvmpipe; *"])
    assert references() == before


@pytest.mark.parametrize("value", ["", "0", "false"])
def test_ci_set_to_nothing_is_not_ci(accepted: Run, monkeypatch: pytest.MonkeyPatch, value: str) -> None:
    monkeypatch.setenv("GALLIUM_DRIVER", "softpipe")
    monkeypatch.setenv("CI", value)
    accepted("-k", "plain").assert_outcomes(skipped=1, deselected=2)


def test_workers_of_xdist_say_what_they_wrote_too(run: Run) -> None:
    pytest.importorskip("xdist")
    result = run("-n", "2", "--shots-update")
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(["*= shots =*"])
    result.stdout.fnmatch_lines_random(
        [f"wrote screenshots/slope/llvmpipe/{shot}.png *" for shot in ("plain", "bright")]
    )
    run("-n", "2").assert_outcomes(passed=3)
