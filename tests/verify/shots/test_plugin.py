"""The plugin on a tiny sketch of a user's own: what passes, what fails and how, and what is written."""

from __future__ import annotations

import json
import re
import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import read_png
from playground.engine.context import ContextInfo
from playground.errors import SandboxCrash, SandboxTimeout
from playground.verify.shots.references import write_reference

from ...loading import load
from ...variants import trust

Run = Callable[..., pytest.RunResult]
Edit = Callable[[str, str, str], None]

FOLDER = Path("screenshots/slope/llvmpipe")


def references() -> list[str]:
    return sorted(path.as_posix() for path in Path("screenshots").rglob("*.png"))


def record(shot: str, folder: str = "shots-report/slope") -> dict[str, object]:
    values: dict[str, object] = json.loads(Path(folder, f"{shot}.json").read_text())
    return values


def put_at(output: str, word: str) -> Path:
    """Return the file that a failure names."""
    result = re.search(rf"^    {word} +(\S.*)$", output, re.MULTILINE)
    assert result, output
    return Path(result[1])


def test_from_nothing_to_a_reference_and_back(run: Run) -> None:
    """A missing reference fails and shows itself; the command that it names writes it; then it passes."""
    result = run("slope.toml")
    result.assert_outcomes(failed=2, passed=1)
    result.stdout.fnmatch_lines(
        ["slope/plain: missing: *", "    reference * screenshots/slope/llvmpipe/plain.png"]
    )
    pixels, _ = read_png(put_at(result.stdout.str(), "actual"))
    assert pixels.shape == (32, 32, 4)
    result.stdout.fnmatch_lines(["    accept it   pytest --shots-update slope.toml::plain"])
    assert record("plain")["word"] == "missing"
    assert references() == []

    result = run("--shots-update", "slope.toml::plain")
    result.assert_outcomes(passed=1)
    result.stdout.fnmatch_lines(
        ["*= shots =*", "wrote screenshots/slope/llvmpipe/plain.png  (missing: *"], consecutive=True
    )
    assert references() == ["screenshots/slope/llvmpipe/plain.png"]
    assert record("plain")["word"] == "same"
    assert not Path("shots-report/slope/plain.actual.png").exists()

    result = run("slope.toml::plain")
    result.assert_outcomes(passed=1)
    result.stdout.no_fnmatch_line("*= shots =*")


def test_update_leaves_what_matches_alone_and_says_so(accepted: Run, edit: Edit) -> None:
    edit("slope.toml", '"height.gain" = 1.0', '"height.gain" = 0.9')
    before = (FOLDER / "plain.png").stat().st_mtime_ns
    result = accepted("slope.toml", "--shots-update")
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(
        ["wrote screenshots/slope/llvmpipe/bright.png  (differs: *", "left 1 as they were, for they match"]
    )
    result.stdout.no_fnmatch_line("*plain.png*")
    assert (FOLDER / "plain.png").stat().st_mtime_ns == before
    accepted("slope.toml").assert_outcomes(passed=3)


@pytest.mark.parametrize("factor", ["0.95", "1.05"], ids=["darker", "brighter"])
def test_visible_kernel_change_fails_with_all_comparison_images(
    accepted: Run, edit: Edit, factor: str
) -> None:
    edit("terrain.glsl", "return gain *", f"return {factor} * gain *")
    result = accepted("slope.toml", "-k", "plain")
    result.assert_outcomes(failed=1, deselected=2)
    output = result.stdout.str()
    actual, expected, shown = (
        read_png(put_at(output, word))[0] for word in ("actual", "expected", "difference")
    )
    signed = actual.astype(int) - expected.astype(int)
    assert (signed <= 0).all() if factor < "1" else (signed >= 0).all()
    most, over = np.abs(signed).max(), np.count_nonzero(np.abs(signed).max(axis=2) > 1)
    assert most in (6, 7)  # the brightest is 0.5 * 31/32 * 255 = 123.5; 5 % of that are 6.2 levels
    message = rf"slope/plain: differs: max difference {most} of 255, at x = \d+, y = 0 from the top left"
    assert re.search(message, output)
    assert f"; {over} of 1024 pixels ({100 * over / 1024:.3g} %) over 1" in output
    np.testing.assert_array_equal(shown[..., :3], 16 * np.abs(signed[..., :3]))
    np.testing.assert_array_equal(expected, read_png(FOLDER / "plain.png")[0])
    assert "the drawn content has changed" in output
    left = record("plain")
    assert (left["word"], left["tier"], left["node"]) == ("differs", "same build", "slope.toml::plain")
    assert left["command"] == "pytest --shots-update slope.toml::plain"


def test_an_invisible_change_passes(accepted: Run, edit: Edit) -> None:
    edit("terrain.glsl", "return gain *", "// the east is up\n    return 0.9999 * gain *")
    accepted("slope.toml").assert_outcomes(passed=3)


def test_each_failure_has_its_own_word_and_next_shot_runs(
    accepted: Run, edit: Edit, ends: dict[str, Exception]
) -> None:
    """Another size, a crash, a hang and a mistake, and a shot that passes, in one run."""
    crash = "drawing slope/crashed crashed: the process was ended by SIGSEGV\n    | nir: validation failed"
    ends["crashed"] = SandboxCrash(crash)
    ends["hung"] = SandboxTimeout("drawing slope/hung took more than 120 s and was stopped")
    edit("slope.toml", "size = [40, 32]", "size = [40, 31]")
    more = "".join(f'[[shot]]\nname = "{name}"\n' for name in ("crashed", "hung", "unreadable", "last"))
    edit("slope.toml", '[[shot]]\nname = "plain"', f'{more}[[shot]]\nname = "plain"')
    (FOLDER / "unreadable.png").write_bytes((FOLDER / "plain.png").read_bytes()[:60])
    result = accepted("slope.toml")
    result.assert_outcomes(failed=5, passed=2)
    result.stdout.fnmatch_lines(
        [
            "slope/crashed: crash: drawing slope/crashed crashed: the process was ended by SIGSEGV",
            "    | nir: validation failed",
            "slope/hung: hang: drawing slope/hung took more than 120 s and was stopped",
            "slope/unreadable: unreadable: *unreadable.png: the file is damaged or cut short*",
            "slope/last: missing: *",
            "slope/bright: size: 40 × 31 pixels where 40 × 32 were expected",
        ]
    )
    words = {
        path.stem: json.loads(path.read_text())["word"] for path in Path("shots-report/slope").glob("*.json")
    }
    assert words == {
        "crashed": "crash",
        "hung": "hang",
        "unreadable": "unreadable",
        "last": "missing",
        "plain": "same",
        "bright": "size",
    }
    assert record("crashed")["error"] == "    | nir: validation failed"
    result = accepted("slope.toml", "--shots-update")
    result.assert_outcomes(failed=2, passed=5)  # what gave no picture cannot be accepted
    accepted("slope.toml", "-k", "not crashed and not hung").assert_outcomes(passed=5, deselected=2)


def test_any_further_reference_may_match_and_update_removes_them(accepted: Run, edit: Edit) -> None:
    edit("terrain.glsl", "return gain *", "return 0.5 * gain *")
    shutil.copy(FOLDER / "plain.png", FOLDER / "plain.2.png")
    result = accepted("slope.toml", "-k", "plain", "--shots-update")
    result.stdout.fnmatch_lines(["wrote *plain.png *", "removed screenshots/slope/llvmpipe/plain.2.png *"])
    shutil.copy(FOLDER / "plain.png", FOLDER / "plain.3.png")
    shutil.copy(FOLDER / "bright.png", FOLDER / "plain.png")
    accepted("slope.toml", "-k", "plain").assert_outcomes(passed=1, deselected=2)
    (FOLDER / "plain.3.png").unlink()
    accepted("slope.toml", "-k", "plain").assert_outcomes(failed=1, deselected=2)


def test_a_broken_picture_fails_and_is_never_written(accepted: Run, edit: Edit) -> None:
    edit("terrain.glsl", "return gain *", "return 0.0 *")
    before = (FOLDER / "plain.png").read_bytes()
    for arguments in ((), ("--shots-update",)):
        result = accepted("slope.toml", *arguments)
        result.assert_outcomes(failed=2, passed=1)
        result.stdout.fnmatch_lines(["slope/plain: blank: all 32 × 32 pixels are (0, 0, 0, 255)"])
        result.stdout.no_fnmatch_line("*accept it*")
    result.stdout.fnmatch_lines(["    not written: a broken picture is never a reference"])
    assert (FOLDER / "plain.png").read_bytes() == before


def test_a_reference_that_no_shot_uses_fails(accepted: Run, edit: Edit) -> None:
    edit("slope.toml", 'name = "bright"', 'name = "brighter"')
    for name in ("pictures/of/mine.png", "pictures/mine.png"):  # no reference, in the same folder
        Path("screenshots", name).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy(
            put_at(accepted("slope.toml", "-k", "brighter").stdout.str(), "actual"), f"screenshots/{name}"
        )
    result = accepted("slope.toml", "--shots-update")
    result.assert_outcomes(failed=1, passed=2)
    result.stdout.fnmatch_lines(
        ["no shot uses 1 reference; remove:", "    screenshots/slope/llvmpipe/bright.png"]
    )
    (FOLDER / "bright.png").unlink()
    accepted("slope.toml").assert_outcomes(passed=3)


def test_references_of_a_sketch_that_is_gone_fail_once(accepted: Run) -> None:
    Path("other.toml").write_text(Path("slope.toml").read_text())
    Path("slope.toml").rename("renamed.toml")
    result = accepted("renamed.toml", "other.toml", "-k", "references")
    result.assert_outcomes(failed=1, passed=1, deselected=4)
    result.stdout.fnmatch_lines(["no shot uses 2 references; remove:", "*slope/llvmpipe/bright.png"])


def test_results_go_where_they_are_wanted(accepted: Run, edit: Edit) -> None:
    edit("terrain.glsl", "return gain *", "return 0.5 * gain *")
    result = accepted("slope.toml", "--shots-output", "out")
    result.assert_outcomes(failed=2, passed=1)
    assert put_at(result.stdout.str(), "actual") == Path("out/slope/plain.actual.png").absolute()
    assert {path.name for path in Path("out/slope").iterdir()} >= {
        f"{shot}.{word}.png" for shot in ("bright", "plain") for word in ("actual", "difference", "expected")
    }
    assert Path("out/.gitignore").read_text().endswith("*\n")


def test_a_mistake_in_a_kernel_fails_with_its_place(accepted: Run, edit: Edit) -> None:
    edit("terrain.glsl", "float(size.x)", "float(siez.x)")
    result = accepted("slope.toml", "-k", "plain")
    result.assert_outcomes(failed=1, deselected=2)
    result.stdout.fnmatch_lines(["slope/plain: *terrain.glsl:7:*siez*"])
    assert record("plain")["word"] == "error"


def test_a_reference_of_another_build_is_named_when_it_differs(accepted: Run) -> None:
    before, _ = read_png(FOLDER / "plain.png")
    other = ContextInfo(450, "llvmpipe (LLVM 19.1.7, 256 bits)", "Mesa", "4.5 Mesa 25.0.7", 4)
    write_reference(load("slope.toml"), "plain", other, before)
    accepted("slope.toml", "-k", "plain").assert_outcomes(passed=1, deselected=2)
    write_reference(load("slope.toml"), "plain", replace(other), 255 - before)
    result = accepted("slope.toml", "-k", "plain")
    result.assert_outcomes(failed=1, deselected=2)
    result.stdout.fnmatch_lines(["*renderer: *; the reference's: llvmpipe (LLVM 19.1.7, 256 bits)"])


@pytest.mark.parametrize("value", ["", "0", "false", "true"])
def test_other_renderer_fails_in_ci_and_skips_elsewhere(
    accepted: Run, monkeypatch: pytest.MonkeyPatch, value: str
) -> None:
    before = references()
    monkeypatch.setenv("CI", value)
    for arguments in ((), ("--shots-update",)):
        result = accepted("slope.toml", "--shots-renderer", "nvidia-h200", *arguments)
        message = "the expected renderer is missing: shots are compared on nvidia-h200; OpenGL gave llvmpipe*"
        if value == "true":
            result.assert_outcomes(failed=2, passed=1)
            result.stdout.fnmatch_lines([f"{message} (a failure, for CI is set)"])
        else:
            result.assert_outcomes(skipped=2, passed=1)
            result.stdout.fnmatch_lines([f"SKIPPED *{message}"])
    assert references() == before


def test_allowed_other_renderer_is_reported_as_compared_loosely(accepted: Run, edit: Edit) -> None:
    """To pytest here, llvmpipe is the other renderer, and the references are of one that is not there."""
    FOLDER.rename(FOLDER.with_name("nvidia-h200"))
    options = ("slope.toml", "--shots-renderer=nvidia-h200", "--shots-any-renderer")
    result = accepted(*options)
    result.assert_outcomes(passed=3)
    message = "2 drawn by llvmpipe, compared by structure only with nvidia-h200's references, "
    message += "as --shots-any-renderer allows"
    result.stdout.fnmatch_lines(["*= shots =*", message])
    assert record("plain")["tier"] == "another renderer"
    edit("terrain.glsl", "return gain *", "return (texel.y > 15 ? 2.0 : 0.3) * gain *")
    result = accepted(*options, "-k", "plain")
    result.assert_outcomes(failed=1, deselected=2)
    update = "pytest --shots-update --shots-renderer=nvidia-h200 --shots-any-renderer slope.toml::plain"
    result.stdout.fnmatch_lines(["slope/plain: structure: *", f"    accept it   {update}"])
    accepted(*options, "-k", "plain", "--shots-update").assert_outcomes(passed=1, deselected=2)
    assert FOLDER.joinpath("plain.png").exists()  # llvmpipe's own, from now on


FAST = """agrees = "1e-4"
[[pass]]
name = "height"
use = "./twin"
[parameters]
gain = "height.gain"
"""


def test_left_out_fast_variant_is_reported_and_may_be_allowed(accepted: Run, edit: Edit) -> None:
    shutil.copyfile("terrain.glsl", "twin.glsl")
    edit("twin.glsl", "return gain *", "return 0.9999 * gain *")
    Path("terrain.fast.toml").write_text(FAST)
    trust(Path.cwd())
    for options in ((), ("--shots-plain",)):
        result = accepted("slope.toml", *options)
        result.assert_outcomes(passed=3)
    edit("terrain.glsl", "return gain *", "return 0.95 * gain *")
    result = accepted("slope.toml")
    result.assert_outcomes(failed=2, passed=1)
    result.stdout.fnmatch_lines(["*= shots =*", "terrain.fast.toml is left out, the plain form runs: *"])
    assert result.stdout.str().count("is left out") == 1
    result = accepted("slope.toml", "--shots-plain")
    result.assert_outcomes(failed=2, passed=1)
    result.stdout.no_fnmatch_line("*accept it*")
    result = accepted("slope.toml", "--shots-plain", "--shots-update")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["*--shots-plain compares with references*"])
