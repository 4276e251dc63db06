"""A few frames of a film, compared as one shot."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from playground.data.image_files import read_png
from playground.verify.shots.judge import frame_size, repeated, strip_of
from playground.verify.shots.results import FRAMES, read_result

Run = Callable[..., pytest.RunResult]
Edit = Callable[[str, str, str], None]


@pytest.mark.parametrize(("count", "columns", "rows"), [(2, 2, 1), (3, 2, 2), (5, 3, 2), (9, 3, 3)])
def test_frames_lie_in_rows_from_the_top_left(count: int, columns: int, rows: int) -> None:
    frames = [np.full((4, 6, 4), number + 1, np.uint8) for number in range(count)]
    strip = strip_of(frames)
    assert strip.shape == (4 * rows, 6 * columns, 4) and frame_size(strip, count) == (6, 4)
    corners = strip[::4, ::6, 0].ravel().tolist()
    assert corners == [*range(1, count + 1), *[0] * (columns * rows - count)]
    mask = np.zeros((4, 6), np.bool_)
    mask[1, 2] = True
    assert np.count_nonzero(repeated(mask, count)) == count


TESTS = """
import numpy as np
RAMP = np.linspace(0, 1, 60).reshape(4, 5, 3)
def test_drawn(shot):
    frames = [
        shot.render("slope.toml", size=(32, 16), time=t, values={"height.gain": g})
        for t, g in [(0, 0.5), (0.5, 0.6), (1, 0.7)]
    ]
    shot.animation(frames, "sunrise")
def test_given(shot):
    shot.animation((RAMP * g for g in (0.2, 0.4)), times=np.array([0, 2]), by="numpy", MASK)
"""


def test_the_first_frame_that_fails_is_named_with_its_time(
    run: Run, pytester: pytest.Pytester, edit: Edit
) -> None:
    pytester.makepyfile(test_sun=TESTS.replace("MASK", ""))
    run("test_sun.py", "--shots-update").assert_outcomes(passed=2)
    strip = read_png(Path("screenshots/test_sun.py/llvmpipe/sunrise.png"))[0]
    assert strip.shape == (32, 64, 4) and not strip[16:, 32:].any()
    run("test_sun.py").assert_outcomes(passed=2)
    edit("test_sun.py", "(0.5, 0.6)", "(0.5, 0.65)")
    edit("test_sun.py", "(1, 0.7)", "(1, 0.75)")
    edit("test_sun.py", "(0.2, 0.4)", "(0.2, 0.0)")
    result = run("test_sun.py", "--shots-update", "-k", "given")
    result.assert_outcomes(failed=1, deselected=1)
    result.stdout.fnmatch_lines(["test_sun.py/given: blank: frame 2 of 2, at 2 s: all 5 × 4 *"])
    result = run("test_sun.py", "-k", "drawn")
    result.assert_outcomes(failed=1, deselected=1)
    message = "test_sun.py/sunrise: differs: frame 2 of 3, at 0.5 s: max difference *; 2 of the 3 frames fail"
    result.stdout.fnmatch_lines([message])
    numbers = read_result(Path("shots-report/test_sun.py/sunrise.json")).numbers
    # Of 3 frames of 32 × 16, without the fourth cell of the strip.
    assert numbers[FRAMES] == 3
    assert numbers["pixels over 1, %"] == pytest.approx(100 * numbers["pixels over 1"] / (3 * 32 * 16))


def test_a_mask_hides_the_same_of_each_frame(run: Run, pytester: pytest.Pytester, edit: Edit) -> None:
    pytester.makepyfile(test_sun=TESTS.replace("MASK", "mask=(1, 2, 2, 1)"))
    run("test_sun.py", "--shots-update", "-k", "given").assert_outcomes(passed=1, deselected=1)
    edit("test_sun.py", "def test_given(shot):", "def test_given(shot):\n    RAMP[2, 1:3] = 0")
    result = run("test_sun.py", "-k", "given")
    result.assert_outcomes(passed=1, deselected=1)
    edit("test_sun.py", "RAMP[2, 1:3]", "RAMP[3, 1:3]")
    result = run("test_sun.py", "-k", "given")
    result.stdout.fnmatch_lines(["test_sun.py/given: differs: frame 1 of 2, at 0 s: * of 18 pixels *"])
