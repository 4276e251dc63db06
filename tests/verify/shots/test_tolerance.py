"""What a shot says of its comparison: a tolerance that lets no change pass, a mask that hides not all."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.data.image_files import read_png, write_png
from playground.errors import SketchError
from playground.sketch.model import TIERS, Tolerance
from playground.verify.shots.compare import Light, mask_of
from playground.verify.shots.judge import Judgement, Rule, judge
from playground.verify.shots.references import Reference
from playground.verify.shots.results import read_result

from ...loading import load
from .conftest import OURS

Picture = NDArray[np.uint8]
Run = Callable[..., pytest.RunResult]
Edit = Callable[[str, str, str], None]

SIZE = (96, 128)
ANYTHING = Tolerance(255, 1.0, "", "for the test")


def land(*, shadow: bool = True) -> Picture:
    """Return a slope with a shadow on it, 23 pixels wide, 4 levels dark where it is faintest."""
    y, x = np.indices(SIZE)
    dark = (np.abs(x - y) < 12) * np.where(x < 64, 4.0, 30.0) * shadow
    grey = 60.0 + x + 0.3 * y - dark
    return np.stack([grey] * 3 + [np.full(SIZE, 255.0)], axis=2).astype(np.uint8)


def judged(actual: Picture, tolerance: Tolerance | None, expected: Picture | None = None) -> Judgement:
    reference = Reference(Path(), land() if expected is None else expected, OURS.texts())
    return judge(actual, OURS, [reference], rule=Rule(tolerance=tolerance))[0]


def because(name: str) -> Tolerance:
    return replace(TIERS[name], reason="for the test")


def noisy(picture: Picture, levels: int, seed: int = 1) -> Picture:
    """Return a picture with independent noise of up to so many levels."""
    noise = np.random.default_rng(seed).integers(-levels, levels + 1, (*SIZE, 4)) * [1, 1, 1, 0]
    return np.clip(picture + noise, 0, 255).astype(np.uint8)


@pytest.mark.parametrize("seed", range(5))
def test_noise_passes_by_its_tier_and_fails_without(seed: int) -> None:
    actual, expected = noisy(land(), 4, seed), noisy(land(), 4, seed + 100)
    result = judged(actual, because("noise"), expected)
    assert result.ok and result.tolerated
    assert result.message.startswith("same, by the tolerance: max difference 8 of 255")
    assert judged(actual, None, expected).word == "differs"
    assert judged(noisy(land(), 9, seed), because("noise")).message.endswith("the tolerance allows 8")


def test_single_pixels_that_fall_the_other_way_pass_as_edges() -> None:
    rows, columns = np.unravel_index(np.arange(0, SIZE[0] * SIZE[1] - 128, 211), SIZE)
    actual = land()
    actual[rows, columns, :3] -= 40
    assert 0.004 < len(rows) / (SIZE[0] * SIZE[1]) < 0.005
    assert judged(actual, because("edges")).ok
    assert not judged(actual, because("rounding")).ok
    actual[rows + 1, columns, :3] -= 40
    assert judged(actual, because("edges")).message.endswith("the tolerance allows 0.5 %")


def in_part() -> Picture:
    """Return the land without the faint part of its shadow."""
    picture = land()
    picture[:, :40] = land(shadow=False)[:, :40]
    return picture


def stripes() -> Picture:
    """Return the land under stripes of ±60 levels, which cancel in any window: a pattern, no noise."""
    bright = np.indices(SIZE)[1] // 4 % 2 * 120 - 60
    return np.clip(land().astype(int) + bright[..., None] * [1, 1, 1, 0], 0, 255).astype(np.uint8)


@pytest.mark.parametrize("tolerance", [*map(because, TIERS), ANYTHING], ids=[*TIERS, "widest"])
@pytest.mark.parametrize(
    "broken",
    [
        pytest.param(land(shadow=False), id="no shadow"),
        pytest.param(in_part(), id="a faint shadow lost in part"),
        pytest.param(land() + np.array([2, 0, 0, 0], np.uint8), id="a hue two levels off"),
        pytest.param(np.roll(land(), 3, axis=1), id="moved"),
        pytest.param(np.ascontiguousarray(land()[::-1]), id="upside down"),
        pytest.param(stripes(), id="stripes"),
        pytest.param(np.full_like(land(), 99), id="blank"),
    ],
)
def test_no_tolerance_lets_a_change_of_what_is_shown_pass(broken: Picture, tolerance: Tolerance) -> None:
    result = judged(broken, tolerance)
    assert not result.ok and result.word in ("differs", "crowded", "blank")


def test_a_shadow_that_is_lost_under_noise_fails() -> None:
    """The sum of its differences over a window stays, where that of the noise does not."""
    result = judged(noisy(land(shadow=False), 8), ANYTHING)
    assert result.word == "crowded" and "no tolerance lets pass" in result.message


def test_a_tolerance_that_is_not_needed_is_named() -> None:
    result = judged(land(), because("noise"))
    assert result.ok and not result.tolerated and result.message.endswith("; the tolerance is not needed")


# ── masks ────────────────────────────────────────────────────────────────────


def test_what_is_masked_counts_as_equal_and_the_rest_in_full() -> None:
    actual = land()
    actual[:10, :20, :3] = 255
    reference = Reference(Path(), land(), OURS.texts())
    mask = mask_of([(0, 0, 20, 10)], SIZE[::-1], Path())
    result = judge(actual, OURS, [reference], rule=Rule(mask=mask))[0]
    assert result.ok and result.message.endswith("200 pixels (1.63 %) are masked")
    actual[50, 50, 0] += 9
    result = judge(actual, OURS, [reference], rule=Rule(mask=mask))[0]
    assert f"1 of {SIZE[0] * SIZE[1] - 200} pixels" in result.message
    assert result.word == "differs" and result.comparison.position == (50, 50)


def test_a_picture_of_one_colour_but_for_what_is_masked_is_blank() -> None:
    actual = np.full_like(land(), 7)
    actual[:10, :20] = land()[:10, :20]
    mask = mask_of([(0, 0, 20, 10)], SIZE[::-1], Path())
    reference = Reference(Path(), land(), OURS.texts())
    assert judge(actual, OURS, [reference], rule=Rule(mask=mask))[0].word == "blank"


def test_a_mask_of_an_image_or_an_array_hides_where_it_is_light(tmp_path: Path) -> None:
    light = np.zeros((4, 6), np.bool_)
    light[1, 2:5] = True
    write_png(tmp_path / "sky.png", np.repeat(light[..., None] * np.uint8(255), 4, axis=2))
    assert np.array_equal(mask_of(["sky.png"], (6, 4), tmp_path), light)
    for values in (light, light * np.float32(0.9), light * np.uint16(40000), light[..., None] * np.ones(3)):
        assert np.array_equal(mask_of([Light(values)], (6, 4), tmp_path), light)


# ── in a sketch and in a test ────────────────────────────────────────────────


def test_a_sketchs_shot_has_a_tolerance_and_a_mask(accepted: Run, edit: Edit) -> None:
    """The texture hides where the slope is lighter than half, which is its right half."""
    edit(
        "slope.toml",
        'name = "bright"\nsize = [40, 32]',
        'name = "bright"\nsize = [32, 32]\nmask = ["height", [0, 0, 4, 32]]\n'
        'tolerance = "noise"\nreason = "the grain"',
    )
    accepted("slope.toml", "-k", "bright", "--shots-update").assert_outcomes(passed=1, deselected=2)
    result = accepted("slope.toml", "-k", "bright")
    result.assert_outcomes(passed=1, deselected=2)
    result.stdout.fnmatch_lines(["slope/bright: the tolerance is not needed: *"])
    left = read_result(Path("shots-report/slope/bright.json"))
    assert left.rules.tolerance == "noise, 8 of 255 at 100 % of the pixels (the grain)"
    assert left.rules.tolerated == "not needed" and left.rules.masked == (
        "4 × 32 pixels at x = 0, y = 0",
        "height",
    )
    # x / 32 is more than half from x = 17 on; with the rectangle that is 4 + 15 of the 32 columns.
    assert left.message.endswith(f"{19 * 32} pixels (59.4 %) are masked")
    edit("slope.toml", "[0, 0, 4, 32]", "[0, 0, 32, 32]")
    result = accepted("slope.toml", "-k", "bright")
    result.assert_outcomes(failed=1, deselected=2)
    result.stdout.fnmatch_lines(["slope/bright: mask: it hides all 32 × 32 pixels, so nothing would be*"])


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ('tolerance = "noise"', r"slope.toml:15: tolerance: it needs a reason, as reason = \"the grain"),
        ('tolerance = "nois"\nreason = "x"', "tolerance = 'nois': .*did you mean 'noise'"),
        ('mask = "heigth"', "mask: no pass 'heigth' in sketch slope.*did you mean 'height'"),
        ('mask = "../secret.png"', "it leads outside the sketch's folder"),
        ("mask = [[0, 0, 0, 4]]", r"expected \[x, y, width, height\] in pixels from the top left"),
    ],
)
def test_a_mistake_in_a_shots_comparison_is_at_its_line(
    run: Run, edit: Edit, keys: str, message: str
) -> None:
    edit("slope.toml", 'name = "plain"', f'name = "plain"\n{keys}')
    with pytest.raises(SketchError, match=message):
        load("slope.toml")


TESTS = """
import numpy as np
RAMP = np.linspace(0, 1, 40 * 50 * 3).reshape(40, 50, 3)
ACTUAL = RAMP.copy()
VALUES = {"height.gain": 1.0}
def test_one(shot):
    shot.check(ACTUAL, "ramp", by="numpy", mask=[(0, 0, 10, 5), "sky.png"], tolerance=9, reason="grain")
def test_drawn(shot):
    shot.check(shot.render("slope.toml", size=(32, 32), values=VALUES), "drawn", mask="height")
"""


def test_check_report_shows_its_tolerance_and_mask(run: Run, pytester: pytest.Pytester, edit: Edit) -> None:
    pytester.makepyfile(test_sea=TESTS)
    sky = np.zeros((40, 50, 4), np.uint8)
    sky[30:, :, 0] = 255
    write_png(Path("sky.png"), sky)
    run("--shots-update", "test_sea.py").assert_outcomes(passed=2)
    edit("test_sea.py", "RAMP.copy()", "RAMP.copy(); ACTUAL[31:, 7] = 0.2; ACTUAL[2, 3] = 1")
    run("--shots-report", "test_sea.py").assert_outcomes(passed=2)
    page = Path("shots-report/index.html").read_text()
    assert "9 of 255 at 0.5 % of the pixels (grain)" in page
    assert "550 pixels (27.5 %) are masked; tolerance" in page
    edit("test_sea.py", "[2, 3] = 1", "[20, 3] = 1")
    edit("test_sea.py", "1.0}", "0.9}")
    run("test_sea.py").assert_outcomes(failed=2)
    left = read_result(Path("shots-report/test_sea.py/ramp.json"))
    assert left.place == (3, 20) and left.rules.masked == ("10 × 5 pixels at x = 0, y = 0", "sky.png")
    pictures = {word: read_png(Path("shots-report") / file)[0] for word, file in left.actual.pictures.items()}
    assert np.array_equal(pictures["masked"][5:30], pictures["actual"][5:30])
    assert (pictures["masked"][30:] != pictures["actual"][30:]).any(axis=2).all()
    assert not pictures["difference"][30:, :, :3].any() and pictures["difference"][20, 3, :3].all()
    assert "Not compared" in Path("shots-report/index.html").read_text()


def test_unknown_mask_pass_in_test_is_one_error_at_test_line(run: Run, pytester: pytest.Pytester) -> None:
    pytester.makepyfile(test_sea=TESTS.replace('mask="height"', 'mask="hieght"'))
    result = run("--shots-update", "test_sea.py::test_drawn")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*SketchError: mask: no pass 'hieght' *; did you mean 'height'?"])
    result.stdout.no_fnmatch_line("*suite.py*")
