"""For a continuous integration: fallbacks, properties, the summary of a step, and what failed before."""

from __future__ import annotations

import re
import xml.etree.ElementTree as ElementTree
from collections.abc import Callable
from pathlib import Path

import pytest

from playground.verify.shots.references import Fallback, fallback_for, fallbacks_of, read_fallbacks
from playground.verify.shots.report import MAX_BYTES, summarise, text_of

Run = Callable[..., pytest.RunResult]
Edit = Callable[[str, str, str], None]

FOLDER = Path("screenshots/slope/llvmpipe")
GITHUB = {
    "GITHUB_SERVER_URL": "https://example.test",
    "GITHUB_REPOSITORY": "owner/land",
    "GITHUB_SHA": "ab12",
}


# ── --shots-update=failed ────────────────────────────────────────────────────


def test_only_what_failed_before_is_written(accepted: Run, edit: Edit) -> None:
    edit("slope.toml", '"height.gain" = 1.0', '"height.gain" = 0.9')
    accepted("slope.toml").assert_outcomes(failed=1, passed=2)
    edit("terrain.glsl", "return gain *", "return 0.8 * gain *")  # now both differ
    before = (FOLDER / "plain.png").read_bytes()
    result = accepted("slope.toml", "--shots-update=failed")
    result.assert_outcomes(failed=1, passed=2)
    result.stdout.fnmatch_lines(["wrote screenshots/slope/llvmpipe/bright.png  (differs: *"])
    result.stdout.fnmatch_lines(["    not written: it had not failed before"])
    assert (FOLDER / "plain.png").read_bytes() == before
    accepted("slope.toml", "--shots-update=failed").assert_outcomes(passed=3)


def test_shots_update_failed_reports_if_nothing_failed_before(accepted: Run) -> None:
    result = accepted("slope.toml", "--shots-update=failed")
    result.assert_outcomes(passed=3)
    result.stdout.fnmatch_lines(["--shots-update=failed wrote nothing: *"])


def test_a_path_after_the_option_is_a_path(accepted: Run) -> None:
    accepted("--shots-update=failed", "slope.toml").assert_outcomes(passed=3)
    result = accepted("--shots-update", "--shots-update=failed", "slope.toml")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(
        ["*--shots-update writes all that fail, --shots-update=failed fewer: give one"]
    )


# ── Progress ─────────────────────────────────────────────────────────────────


@pytest.mark.slow
@pytest.mark.parametrize("workers", [(), ("-n", "1", "--dist", "loadfile")])
def test_the_progress_ends_at_a_hundred_percent(run: Run, workers: tuple[str, ...]) -> None:
    """Unused references are reported as a test that was not collected."""
    Path("test_land.py").write_text(
        "def test_one(shot):\n    shot.check(__import__('numpy').eye(9), 'one', by='numpy')\n"
    )
    stale = Path("screenshots/test_land.py/llvmpipe/gone.png")
    stale.parent.mkdir(parents=True)
    stale.write_bytes(b"")
    result = run("test_land.py", "--shots-update", *workers)
    result.assert_outcomes(passed=1, failed=1)
    percents = [int(result) for result in re.findall(r"\[ *(\d+)%\]", result.stdout.str())]
    assert percents and max(percents) == 100


# ── Fallbacks ────────────────────────────────────────────────────────────────


def test_a_line_that_is_wrong_is_a_usage_error(run: Run) -> None:
    result = run("slope.toml", "-o", "shots_fallbacks=apple-m1")
    assert result.ret == pytest.ExitCode.USAGE_ERROR
    result.stderr.fnmatch_lines(["*shots_fallbacks: *expected 'RENDERER = RENDERER'*"])


def test_the_first_line_whose_references_are_there_counts() -> None:
    table = read_fallbacks(["apple-m1 = apple-m2, pixels", "apple-* = llvmpipe", "amd = llvmpipe"])
    assert table[1] == Fallback("apple-*", "llvmpipe", "structure")
    assert [line.references for line in fallbacks_of(table, "apple-m1")] == ["apple-m2", "llvmpipe"]
    assert fallbacks_of(table, "nvidia") == []
    for there, expected in (({"apple-m2", "llvmpipe"}, 0), ({"llvmpipe"}, 1), (set(), 0)):
        assert fallback_for(table, "apple-m1", there.__contains__) == table[expected]
    assert fallback_for(table, "nvidia", lambda _: True) is None


def test_fallback_renderer_references_are_used_and_reported(accepted: Run, edit: Edit) -> None:
    """To pytest here, llvmpipe is the renderer without references, and apple-m1 one that is not there."""
    FOLDER.rename(FOLDER.with_name("apple-m1"))
    missing = accepted("slope.toml")
    missing.assert_outcomes(failed=2, passed=1)
    declared = ("slope.toml", "-o", "shots_fallbacks=llvm* = apple-m1", "--junitxml=found.xml")
    result = accepted(*declared)
    result.assert_outcomes(passed=3)
    message = "drawn by llvmpipe, compared by structure only with apple-m1's references, "
    message += "as shots_fallbacks has it (llvm* = apple-m1, structure)"
    result.stdout.fnmatch_lines([f"2 {message}".replace("*", "[*]")])
    assert properties("found.xml", "plain")["shot.stands-in"] == message

    edit("terrain.glsl", "return gain *", "return 0.99 * gain *")  # a little darker: no defect of structure
    accepted(*declared).assert_outcomes(passed=3)
    strictly = accepted("slope.toml", "-o", "shots_fallbacks=llvm* = apple-m1, pixels")
    strictly.assert_outcomes(failed=2, passed=1)
    strictly.stdout.fnmatch_lines(["slope/plain: differs: *"])


def test_fallback_renderer_may_draw_for_expected_one(accepted: Run) -> None:
    FOLDER.rename(FOLDER.with_name("apple-m1"))
    options = ("slope.toml", "--shots-renderer=apple-m1")
    accepted(*options).assert_outcomes(skipped=2, passed=1)
    accepted(*options, "-o", "shots_fallbacks=llvmpipe = apple-m1").assert_outcomes(passed=3)


# ── --junitxml ───────────────────────────────────────────────────────────────


def properties(file: str, test: str) -> dict[str, str]:
    [case] = [item for item in ElementTree.parse(file).iter("testcase") if item.get("name") == test]
    return {str(item.get("name")): str(item.get("value")) for item in case.iter("property")}


def test_a_test_says_its_renderer_scores_reference_and_pictures(accepted: Run, edit: Edit) -> None:
    edit("slope.toml", '"height.gain" = 1.0', '"height.gain" = 0.9')
    accepted("slope.toml", "--junitxml=found.xml").assert_outcomes(failed=1, passed=2)
    good, bad = properties("found.xml", "plain"), properties("found.xml", "bright")
    for actual, name, result in ((good, "plain", "same"), (bad, "bright", "differs")):
        assert actual["shot"] == f"slope/{name}"
        assert actual["shot.result"] == result
        assert actual["shot.renderer"] == "llvmpipe"
        assert actual["shot.reference"] == f"screenshots/slope/llvmpipe/{name}.png"
    assert good["shot.score.largest difference, levels of 255"] == "0"
    assert float(bad["shot.score.largest difference, levels of 255"]) == pytest.approx(25.5, abs=1)
    assert not any(name.startswith("shot.picture") for name in good)
    for word in ("actual", "expected", "difference", "flip"):
        assert bad[f"shot.picture.{word}"] == f"shots-report/slope/bright.{word}.png"
        assert Path(bad[f"shot.picture.{word}"]).exists()


# ── The summary of a step ────────────────────────────────────────────────────


def test_a_step_s_summary_shows_what_failed(
    accepted: Run, edit: Edit, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    file = tmp_path / "summary.md"
    for name, value in {**GITHUB, "GITHUB_STEP_SUMMARY": str(file)}.items():
        monkeypatch.setenv(name, value)
    monkeypatch.setenv("GITHUB_WORKSPACE", str(Path.cwd()))
    accepted("slope.toml").assert_outcomes(passed=3)
    assert file.read_text() == "## 2 shots: all as expected\n\n"
    edit("slope.toml", '"height.gain" = 1.0', '"height.gain" = 0.9')
    url = "https://example.test/results"
    accepted("slope.toml", f"--shots-pictures-url={url}").assert_outcomes(failed=1, passed=2)
    text = file.read_text()
    assert "## 1 of 2 shots failed" in text
    [row] = [line for line in text.splitlines() if "slope/bright" in line]
    assert row.count(" | ") == 3
    reference = "https://example.test/owner/land/raw/ab12/screenshots/slope/llvmpipe/bright.png"
    assert re.findall(r'src="([^"]*)"', row) == [
        reference,
        f"{url}/slope/bright.actual.png",
        f"{url}/slope/bright.difference.png",
    ]
    assert "shots-report" in text and "playground shots review" in text


def test_without_an_address_it_says_where_the_pictures_are() -> None:
    shot = {"shot": "a/b", "shot.result": "differs", "shot.picture.actual": "shots-report/a/b.actual.png"}
    text = text_of([shot], Path("shots-report"), "", {})
    assert "<img" not in text
    assert "have no address" in text


def test_names_cannot_break_its_table() -> None:
    shot = {"shot": "a|b<img src=x>/`c`", "shot.result": "differs"}
    [row] = [line for line in text_of([shot], Path("r"), "", {}).splitlines() if "c" in line and "a&" in line]
    assert row.count("|") == 5 and "<img src=x" not in row and "`" not in row


def test_it_stays_below_what_github_shows(tmp_path: Path) -> None:
    shots = [{"shot": f"hills/{n:05d}", "shot.result": "differs"} for n in range(30_000)]
    file = tmp_path / "summary.md"
    file.write_text("before\n" * 1000)
    assert summarise(shots, Path("shots-report"), environment={"GITHUB_STEP_SUMMARY": str(file)}) == ""
    text = file.read_text()
    assert MAX_BYTES - 1000 < len(text.encode()) <= MAX_BYTES
    left = int(re.findall(r"^(\d+) failed shots more", text, re.MULTILINE)[0])
    assert text.count("hills/") == 30_000 - left


def test_where_it_cannot_be_written_that_is_said(tmp_path: Path) -> None:
    value = {"GITHUB_STEP_SUMMARY": str(tmp_path)}
    said = summarise([{"shot": "a/b", "shot.result": "same"}], Path("r"), environment=value)
    assert said.startswith(f"no step summary: {tmp_path}: ")
