"""Pictures of any origin: numbers to levels, adapters, names, and tests that check several."""

from __future__ import annotations

import gc
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import PIL.Image
import pytest

from playground.api import headless
from playground.data.image_files import read_png
from playground.verify.shots.adapters import levels_of, picture_from
from playground.verify.shots.names import MAX_NAME, name_of_test, one_spelling, why_no_name

Run = Callable[..., pytest.RunResult]

# ── numbers ──────────────────────────────────────────────────────────────────


def test_grey_alpha_and_wide_integers_round_to_nearest_level() -> None:
    grey = np.array([[0, 128, 255]], np.uint8)
    assert levels_of(grey)[0].tolist() == [[[v, v, v, 255] for v in (0, 128, 255)]]
    assert levels_of(grey[..., None])[0].tolist() == levels_of(grey)[0].tolist()
    assert levels_of(np.array([[[7, 9]]], np.uint8))[0].tolist() == [[[7, 7, 7, 9]]]
    assert levels_of(np.array([[True, False]]))[0][0, :, 0].tolist() == [255, 0]
    # Every number of 16 bits, in exact integers: level = round(255 v / 65535) = round(v / 257).
    wide = np.arange(65536, dtype=np.uint16)[None]
    expected = (wide.astype(np.int64) + 128) // 257
    assert levels_of(wide)[0][0, :, 0].tolist() == expected[0].tolist()


def test_floats_that_round_to_the_last_level_are_that_level() -> None:
    edge = np.array([[1.0 + 0.4 / 255, -0.4 / 255, 1.0]])
    assert levels_of(edge)[0][0, :, 0].tolist() == [255, 0, 255]


def test_a_tone_follows_its_stated_rule_and_leaves_alpha_alone() -> None:
    light = np.array([[[0.0, 0.18, 1.0, 0.5], [4.0, 0.0031308, 0.5, 1.0]]])

    def encoded(x: float) -> int:  # IEC 61966-2-1, in its own words
        return round(255 * (12.92 * x if x <= 0.0031308 else 1.055 * x ** (1 / 2.4) - 0.055))

    srgb, reinhard, clip = (levels_of(light, tone)[0] for tone in ("srgb", "reinhard", "clip"))
    assert srgb[0, :, :3].tolist() == [[0, encoded(0.18), 255], [255, encoded(0.0031308), encoded(0.5)]]
    assert reinhard[0, 1, 0] == encoded(4 / 5) and reinhard[0, 0, 2] == encoded(1 / 2)
    assert clip[0, :, 0].tolist() == [0, 255]
    assert all(shown[0, :, 3].tolist() == [128, 255] for shown in (srgb, reinhard, clip))


# ── adapters ─────────────────────────────────────────────────────────────────

PIXELS = (np.arange(2 * 3 * 4, dtype=np.uint8) * 10).reshape(2, 3, 4)


def made_in(package: str, **members: object) -> object:
    """Return an object whose class says that it is of a package."""
    return type("Canvas", (), {"__module__": f"{package}.app.canvas", **members})()


@pytest.mark.parametrize(
    "thing",
    [
        pytest.param(made_in("vispy", render=lambda self: PIXELS), id="vispy canvas"),
        pytest.param(made_in("pygfx", snapshot=lambda self: PIXELS), id="pygfx renderer"),
        pytest.param(made_in("rendercanvas", draw=lambda self: memoryview(PIXELS)), id="rendercanvas"),
        pytest.param(made_in("anything", to_rgba=lambda self: PIXELS), id="to_rgba"),
        pytest.param(made_in("anything", __array__=lambda self, *_, **__: PIXELS), id="__array__"),
        pytest.param(PIL.Image.fromarray(PIXELS), id="Pillow"),
        pytest.param(PIXELS.tolist(), id="lists"),
    ],
)
def test_what_holds_a_picture_gives_it(thing: object) -> None:
    assert picture_from(thing).values.tolist() == PIXELS.tolist()


def test_images_of_pillow_of_any_mode() -> None:
    grey = PIL.Image.fromarray(PIXELS[..., 0])
    assert levels_of(picture_from(grey).values)[0][..., 2].tolist() == PIXELS[..., 0].tolist()
    wide = PIL.Image.fromarray(PIXELS[..., 0].astype(np.uint16) * 257)
    assert picture_from(wide).values.dtype == np.uint16
    assert levels_of(picture_from(wide).values)[0][..., 0].tolist() == PIXELS[..., 0].tolist()


@pytest.fixture
def uncollected() -> Iterator[None]:
    """Collect no garbage: objects of another test's context are deleted by number, in the current one."""
    gc.collect()
    gc.disable()
    yield
    gc.enable()


@pytest.mark.usefixtures("uncollected")
@pytest.mark.parametrize(("kind", "samples"), [("f1", 0), ("f4", 0), ("nu2", 0), ("f1", 4), ("f4", 4)])
def test_what_moderngl_drew_has_its_top_row_first(kind: str, samples: int) -> None:
    """The north half is cleared to another colour: it is what comes first."""
    with headless(software=True) as engine, headless(software=True) as beside:
        context, size = engine.ctx, (6, 4)
        context.__enter__()
        attachment = (
            context.renderbuffer(size, 4, samples=samples, dtype=kind)
            if samples
            else context.texture(size, 4, dtype=kind)
        )
        framebuffer = context.framebuffer([attachment])
        framebuffer.clear(1.0, 0.5, 0.0, 1.0)
        framebuffer.clear(0.0, 0.0, 1.0, 1.0, viewport=(0, 2, 6, 2))
        beside.ctx.__enter__()  # is current now, and has a framebuffer of that number
        beside.ctx.simple_framebuffer(size).clear(0.3, 0.3, 0.3)
        result = picture_from(framebuffer)
        assert result.context is context
        pixels = levels_of(result.values)[0]
        assert pixels[:2].tolist() == [[[0, 0, 255, 255]] * 6] * 2
        assert np.abs(pixels[2:].astype(int) - [255, 127.5, 0, 255]).max() <= 0.5
        window = made_in("moderngl_window", fbo=framebuffer, ctx=context)
        app = made_in("moderngl_window", wnd=window)
        for source in (window, app):
            assert picture_from(source).values.tolist() == result.values.tolist()
        if not samples:
            assert picture_from(attachment).values.tolist() == result.values.tolist()


# ── names ────────────────────────────────────────────────────────────────────


@pytest.mark.parametrize(
    ("node", "name"),
    [
        ("a/test_sea.py::test_waves", "waves"),
        ("test_sea.py::TestSea::test_waves[calm-2]", "Sea-waves-calm-2"),
        ("test_sea.py::test_con", "test_con"),
        ("test_sea.py::test_references", "test_references"),
    ],
)
def test_a_picture_is_named_after_its_test(node: str, name: str) -> None:
    assert name_of_test(node) == name and not why_no_name(name)


def test_ids_differing_in_invalid_file_characters_stay_distinct() -> None:
    ids = [
        "1.0",
        "1,0",
        "1-0",
        "1/0",
        "1:0",
        "1\\0",
        "a",
        "A",
        "a::b",
        "é",
        "e\u0301",
        " ",
        "x" * 200,
        "x" * 201,
        "[",
        "]",
    ]
    names = [name_of_test(f"test_sea.py::test_waves[{text}]") for text in ids]
    assert len({one_spelling(name) for name in names}) == len(ids)
    assert all(not why_no_name(name) and name.isascii() and len(name) <= MAX_NAME for name in names)
    assert names[0].startswith("waves-1-0-") and names[2] == "waves-1-0"


@pytest.mark.parametrize("name", ["con", "AUX", "Lpt1", "a b", "a.b", "a/b", "", "x" * (MAX_NAME + 1)])
def test_what_no_system_has_as_a_file_is_no_name(name: str) -> None:
    assert why_no_name(name)


NAMED = """
import numpy as np
import pytest
RAMP = np.linspace(0, 1, 60).reshape(4, 5, 3)
"""


def test_a_check_without_a_name_takes_its_tests(run: Run, pytester: pytest.Pytester) -> None:
    tests = """
@pytest.mark.parametrize("height", [1.0, 2.0])
def test_waves(shot, height): shot.check(RAMP / height, by="numpy")
def test_twice(shot):
    shot.check(RAMP, by="numpy")
    shot.check(RAMP, by="numpy")
"""
    pytester.makepyfile(test_sea=NAMED + tests)
    result = run("--shots-update", "--tb=short")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(["E   ValueError: a second picture without a name in this test: *"])
    names = sorted(path.name for path in Path("screenshots/test_sea.py/numpy").iterdir())
    assert len(names) == 3 and names[0] == "twice.png"
    assert all(name.startswith(f"waves-{n}-0-") for n, name in enumerate(names[1:], 1))
    assert not list(Path("shots-report").rglob(".names"))


@pytest.mark.parametrize(
    ("first", "other", "message"),
    [
        ("'Dawn'", "'dawn'", "the same file as 'dawn' on macOS and Windows"),
        ("'dawn'", "", "test_sea.py::test_1 has a picture of that name, 'dawn'"),
        ("'day'", "'day'", "test_sea.py::test_1 has just written another picture of that name"),
    ],
    ids=["case", "own", "written"],
)
@pytest.mark.parametrize("workers", ["0", pytest.param("2", marks=pytest.mark.slow)])
def test_two_tests_may_not_have_one_name(
    run: Run, pytester: pytest.Pytester, first: str, other: str, message: str, workers: str
) -> None:
    """Also in processes of their own: the second waits for the first one's claim, and no longer."""
    name = "dawn" if not other else "2"
    pytester.makepyfile(
        test_sea=f"""{NAMED}
import pathlib, time
def test_1(shot):
    shot.check(RAMP, {first}, by="numpy")
    pathlib.Path("first").touch()
def test_{name}(shot):
    while not pathlib.Path("first").exists(): time.sleep(0.01)
    shot.check(RAMP[::-1], {other or "''"}, by="numpy")
"""
    )
    extra = ("-n", workers, "--dist", "load") if workers != "0" else ()
    result = run("--shots-update", *extra)
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines([f"*{message}*"])
    (written,) = Path("screenshots").rglob("*.png")
    assert read_png(written)[0][0, 0, 0] == 0  # the first one's


def test_matching_reference_is_not_rewritten_by_another_test(run: Run, pytester: pytest.Pytester) -> None:
    """Else the tests would take turns in writing it, and each --shots-update would say that all is well."""
    test = "def test_{0}(shot): shot.check(RAMP[::{1}], 'sea', by='numpy')\n"
    both = test.format("first", 1) + test.format("second", -1)
    pytester.makepyfile(test_sea=NAMED + both)
    run("--shots-update", "-k", "first").assert_outcomes(passed=1, deselected=1)
    result = run("--shots-update")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(
        ["test_sea.py/sea: *: test_sea.py::test_first has a picture of that name that matches: give one *"]
    )
    (kept,) = Path("screenshots").rglob("*.png")
    assert read_png(kept)[0][0, 0, 0] == 0  # the first one's


# ── several checks in a test ─────────────────────────────────────────────────

SEVERAL = """
def test_day(shot):
    assert shot.check(RAMP, "dawn", by="numpy") is GOOD
    shot.check(RAMP * 0.5, "noon", by="numpy")
    assert shot.check(RAMP * 0.9 if GOOD else RAMP[:, ::-1], "dusk", by="numpy") is GOOD
    END
"""


@pytest.fixture
def several(run: Run, pytester: pytest.Pytester) -> Callable[[str], pytest.RunResult]:
    """Give what runs a test of three pictures of which two differ, with an end."""
    pytester.makepyfile(test_day=NAMED + "GOOD = True" + SEVERAL.replace("END", ""))
    run("--shots-update").assert_outcomes(passed=1)

    def broken(end: str) -> pytest.RunResult:
        text = NAMED + "GOOD = False; RAMP = RAMP[::-1]" + SEVERAL.replace("END", end)
        Path("test_day.py").write_text(text.replace("RAMP * 0.5", "RAMP[::-1] * 0.5"))
        return run("--tb=short")

    return broken


BOTH = [
    "*2 pictures of this test fail:",
    "*test_day.py/dawn: differs: *",
    "*checked at  test_day.py:7",
    "*test_day.py/dusk: differs: *",
    "*checked at  test_day.py:9",
]


def test_all_checks_of_a_test_are_made_and_reported_together(
    several: Callable[[str], pytest.RunResult],
) -> None:
    result = several("")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(BOTH)
    left = sorted(path.name for path in Path("shots-report/test_day.py").glob("*.actual.png"))
    assert left == ["dawn.actual.png", "dusk.actual.png"]


def test_what_is_no_picture_is_reported_with_the_other_checks(run: Run, pytester: pytest.Pytester) -> None:
    """And is in the report: a mask that hides everything, light that no tone is given for, a film of one."""
    pytester.makepyfile(
        test_day=f"""{NAMED}
def test_day(shot):
    assert not shot.check(RAMP * 4, "dawn", by="numpy")
    assert not shot.check(RAMP, "noon", by="numpy", mask=(0, 0, 5, 4))
    assert not shot.animation([RAMP], "dusk", by="numpy")
    assert not shot.animation([RAMP, RAMP * 2], "evening", by="numpy")
    assert shot.check(RAMP, "night", by="numpy")
"""
    )
    result = run("--shots-update", "--tb=short")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(
        [
            "4 pictures of this test fail:",
            "test_day.py/dawn: a picture of floats is from 0 to 1, and this one from 0 to 4; say what *",
            "*checked at  test_day.py:6",
            "test_day.py/noon: mask: it hides all 5 × 4 pixels, *",
            "test_day.py/dusk: an animation is two frames or more; found 1",
            "test_day.py/evening: frame 2: a picture of floats is from 0 to 1, *",
        ]
    )
    assert [path.name for path in Path("screenshots").rglob("*.png")] == ["night.png"]
    assert "this one from 0 to 4" in Path("shots-report/index.html").read_text()


@pytest.mark.parametrize("end", ["raise KeyError('tide')", "pytest.fail('tide')", "pytest.skip('tide')"])
def test_exception_in_test_is_shown_with_differing_pictures(
    several: Callable[[str], pytest.RunResult], end: str
) -> None:
    result = several(end)
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(BOTH)
    lines = result.stdout.lines
    raised = next(i for i, line in enumerate(lines) if "tide" in line)
    first = next(i for i, line in enumerate(lines) if "dawn: differs" in line)
    assert (raised > first) is ("skip" in end)


def test_a_check_after_the_test_itself_is_not_lost(run: Run, pytester: pytest.Pytester) -> None:
    fixture = "@pytest.fixture\ndef sea(shot):\n    yield\n    shot.check(RAMP, 'late', by='numpy')\n"
    pytester.makepyfile(test_late=f"{NAMED}{fixture}def test_one(sea): pass")
    run().assert_outcomes(passed=1, errors=1)


def test_a_picture_of_one_colour_passes_where_it_is_allowed(run: Run, pytester: pytest.Pytester) -> None:
    call = "shot.check(np.zeros((4, 4), np.uint8), 'night', by='numpy'{})"
    pytester.makepyfile(test_night=f"{NAMED}def test_one(shot): {call.format(', allow_blank=True')}")
    run("--shots-update").assert_outcomes(passed=1)
    run().assert_outcomes(passed=1)
    Path("test_night.py").write_text(f"{NAMED}def test_one(shot): {call.format('')}")
    result = run()
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["test_night.py/night: blank: *"])
