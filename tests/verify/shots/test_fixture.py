"""The `shot` fixture: pictures of tests in Python, drawn apart or given, and references that none uses."""

from __future__ import annotations

import os
from collections.abc import Callable
from pathlib import Path

import pytest

from playground.data.image_files import read_png

Run = Callable[..., pytest.RunResult]
Edit = Callable[[str, str, str], None]

TESTS = """
import numpy as np
import pytest

RAMP = np.linspace(0, 1, 4 * 5 * 3).reshape(4, 5, 3)

def test_drawn(shot):
    frame = shot.render("slope.toml", shot="bright", values={"height.gain": 0.7}, size=(32, 16))
    assert frame.size == (32, 16)
    shot.check(frame, "seven")

def test_given(shot):
    shot.check(RAMP, "ramp", by="numpy")
    shot.check((255 * RAMP).round().astype(np.uint8), "ramp-of-bytes", by="numpy")
"""
FOLDER = Path("screenshots/test_slope.py")


@pytest.fixture
def tests(write_references: Callable[[str, int], Run], pytester: pytest.Pytester) -> Run:
    """Give what runs pytest where a test file has its references."""
    pytester.makepyfile(test_slope=TESTS)
    return write_references("test_slope.py", 2)


def test_references_are_next_to_the_test_file_by_renderer(tests: Run) -> None:
    files = sorted(path.relative_to(FOLDER).as_posix() for path in FOLDER.rglob("*.png"))
    assert files == ["llvmpipe/seven.png", "numpy/ramp-of-bytes.png", "numpy/ramp.png"]
    pixels, text = read_png(FOLDER / "numpy/ramp.png")
    assert (text["sketch"], text["shot"]) == ("test_slope.py", "ramp")
    assert pixels[0, 0].tolist() == [0, 4, 9, 255] and pixels.shape == (4, 5, 4)
    assert "llvm" in read_png(FOLDER / "llvmpipe/seven.png")[1]
    tests().assert_outcomes(passed=2)
    tests("-m", "shots").assert_outcomes(passed=2)


def test_a_change_fails_with_what_accepts_it(tests: Run, edit: Edit) -> None:
    edit("test_slope.py", "0.7", "0.8")
    edit("test_slope.py", "shot.check(RAMP,", "shot.check(RAMP[::-1],")
    result = tests()
    result.assert_outcomes(failed=2)
    result.stdout.fnmatch_lines(
        [
            "test_slope.py/seven: differs: max difference *",
            "    accept it   pytest --shots-update test_slope.py::test_drawn",
            "test_slope.py/ramp: differs: max difference *",
        ]
    )
    tests("--shots-update").assert_outcomes(passed=2)


def test_broken_numbers_are_reported_by_their_word(tests: Run, edit: Edit) -> None:
    edit("test_slope.py", "shot.check(RAMP,", "ramp = RAMP.copy(); ramp[1, 2, 0] = np.nan; shot.check(ramp,")
    for arguments in ((), ("--shots-update",)):
        result = tests("-k", "given", *arguments)
        result.assert_outcomes(failed=1, deselected=1)
        result.stdout.fnmatch_lines(["test_slope.py/ramp: nan: 1 of 20 pixels are not finite numbers"])


ENGINE_TESTS = """
import pytest
from playground.api import headless

@pytest.fixture
def engine():
    with headless(software=True) as made:
        yield made

def test_last(shot, engine):
    shot.check(engine.render("slope.toml", size=(32, 32)), "last", by=engine)

def test_part(shot, engine):
    shot.check(engine.render("slope.toml", size=(32, 32)).array[:16], "part", by=engine)

def test_earlier(shot, engine):
    first = engine.render("slope.toml", size=(32, 32))
    engine.render("slope.toml", size=(32, 33))
    shot.check(first, "earlier", by=engine)
"""


@pytest.mark.slow
def test_what_went_into_an_engines_last_frame_is_looked_at(
    run: Run, edit: Edit, pytester: pytest.Pytester
) -> None:
    pytester.makepyfile(test_engine=ENGINE_TESTS)
    result = run("--shots-update", "--tb=short")
    result.assert_outcomes(passed=2, failed=1)
    result.stdout.fnmatch_lines(
        ["test_engine.py:18: in test_earlier", "E   ValueError: this is not the last*"]
    )
    folder = Path("screenshots/test_engine.py/llvmpipe")
    assert read_png(folder / "last.png")[1]["drawn"] and "drawn" not in read_png(folder / "part.png")[1]
    # One texel of the terrain is no number: in the picture that is a dark spot, and no more.
    edit(
        "terrain.glsl",
        "return gain *",
        "if (texel == ivec2(5, 7)) return sqrt(gain - 2.0);\n    return gain *",
    )
    before = (folder / "last.png").read_bytes()
    for arguments in ((), ("--shots-update",)):
        result = run("-k", "last", *arguments)
        result.assert_outcomes(failed=1, deselected=2)
        result.stdout.fnmatch_lines(["test_engine.py/last: nan: pass 'height', * at texel (5, 7) *"])
    assert (folder / "last.png").read_bytes() == before


def test_a_name_may_begin_with_a_digit(run: Run, pytester: pytest.Pytester) -> None:
    call = "shot.check(np.linspace(0, 1, 48).reshape(4, 4, 3), '3d-view', by='numpy')"
    pytester.makepyfile(test_digit=f"import numpy as np\ndef test_one(shot): {call}")
    run("--shots-update").assert_outcomes(passed=1)
    assert Path("screenshots/test_digit.py/numpy/3d-view.png").is_file()


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (
            "shot.check(RAMP, 'a', by='numpy'); shot.check(RAMP, 'a', by='numpy')",
            "a second picture named 'a'",
        ),
        ("shot.check(RAMP, 'a b', by='numpy')", "a picture needs a name of letters, digits, _ and -"),
        ("shot.check(RAMP, 'a')", "what drew this picture is not known: say by=engine"),
        ("shot.check(RAMP, 'a', by='My GPU')", "by = 'My GPU': a folder's name is lower-case letters"),
        ("shot.check(RAMP, 'a', by='numpy', tolerance='noise')", "tolerance: it needs a reason, as reason ="),
        ("shot.check(RAMP, 'a', by='numpy', mask=7)", "mask = 7: expected a rectangle (x, y, width, height)"),
        ("shot.render('slope.toml', shot='brihgt')", "no shot 'brihgt'*did you mean 'bright'"),
        ("shot.render('slope.toml', values={'height.gian': 1})", "*did you mean 'height.gain'"),
    ],
)
def test_a_mistake_is_reported_at_the_tests_own_line(tests: Run, edit: Edit, call: str, message: str) -> None:
    edit("test_slope.py", 'shot.check(RAMP, "ramp", by="numpy")', call)
    result = tests("-k", "given", "--shots-update", "--tb=short")
    result.assert_outcomes(failed=1, deselected=1)
    result.stdout.fnmatch_lines(["test_slope.py:12: in test_given", f"E   *{message}*"])


def test_two_tests_may_not_write_one_reference_differently(tests: Run, edit: Edit) -> None:
    text = Path("test_slope.py").read_text()
    both = "shot.check(RAMP * 0.5, 'one', by='numpy')"
    Path("test_slope.py").write_text(
        f"{text}\ndef test_a(shot):\n    {both}\ndef test_b(shot):\n    {both}\n"
    )
    tests("--shots-update", "-k", "test_a or test_b").assert_outcomes(passed=2, deselected=2)
    edit(
        "test_slope.py",
        f"def test_b(shot):\n    {both}",
        f"def test_b(shot):\n    {both.replace('0.5', '0.6')}",
    )
    (FOLDER / "numpy/one.png").unlink()
    result = tests("--shots-update", "-k", "test_a or test_b")
    result.assert_outcomes(passed=1, failed=1, deselected=2)
    result.stdout.fnmatch_lines(
        ["*one.png: test_slope.py::test_a has just written another picture of that name"]
    )


def test_opengl_shots_are_skipped_without_expected_renderer(tests: Run) -> None:
    tests("--shots-renderer", "nvidia-h200").assert_outcomes(passed=1, skipped=1)


STALE = ["no test uses 1 reference; remove:", "    screenshots/test_slope.py/llvmpipe/seven.png"]


@pytest.mark.slow
def test_unused_reference_fails_when_all_tests_of_file_ran(tests: Run, edit: Edit) -> None:
    edit("test_slope.py", '"seven"', '"eight"')
    result = tests("--shots-update")
    result.assert_outcomes(passed=2, failed=1)
    assert result.ret == pytest.ExitCode.TESTS_FAILED
    result.stdout.fnmatch_lines([*STALE, "FAILED test_slope.py::references*"])
    # Where not all of them ran, or one did not pass, it is not known.
    for arguments in (
        ("-k", "drawn"),
        ("test_slope.py::test_drawn",),
        ("--deselect", "test_slope.py::test_given"),
    ):
        assert tests(*arguments).ret == pytest.ExitCode.OK
    edit("test_slope.py", "def test_given(shot):", "def test_given(shot):\n    pytest.skip()")
    tests().assert_outcomes(passed=1, skipped=1)
    edit("test_slope.py", "    pytest.skip()", "    return")
    result = tests()
    result.assert_outcomes(passed=1, failed=2)  # one of them: it checks nothing
    result.stdout.fnmatch_lines(["no test uses 3 references; remove:", "*numpy/ramp.png"])


UNCHECKED = """import numpy as np, pytest
RAMP = np.linspace(0, 1, 48).reshape(4, 4, 3)
@pytest.fixture
def late(shot):
    yield
    shot.check(RAMP, 'late', by='numpy')
@pytest.fixture
def helper(shot):
    return lambda name: shot.check(RAMP, name, by='numpy')
@pytest.fixture
def idle(shot):
    yield
def test_nothing(shot): pass
@pytest.mark.parametrize('n', [0, 1])
def test_some(shot, n):
    if n: shot.check(RAMP, 'some', by='numpy')
def test_late(late): pass
def test_helper(helper): helper('helped')
def test_idle(idle): pass
def test_asked(request): request.getfixturevalue('shot')
def test_refused(shot):
    with pytest.raises(ValueError): shot.check(RAMP, 'a b', by='numpy')
def test_skipped(shot): pytest.skip()
@pytest.mark.xfail(reason='later', raises=ZeroDivisionError, strict=True)
def test_expected(shot): 1 / 0
def test_wrong(shot): assert 0, 'its own failure'
def test_without(): pass
"""


def test_a_test_that_checks_no_picture_fails(run: Run, pytester: pytest.Pytester) -> None:
    pytester.makepyfile(test_sea=UNCHECKED)
    result = run("--shots-update", "-rfE")
    # Failed: nothing, some[0], asked, wrong. An error: idle, whose fixture might have checked after the test.
    result.assert_outcomes(passed=6, failed=4, errors=1, skipped=1, xfailed=1)
    names = sorted(
        line.partition("::")[2].partition(" - ")[0]
        for line in result.outlines
        if line[:5] in ("FAILE", "ERROR") and "::" in line
    )
    assert names == ["test_asked", "test_idle", "test_nothing", "test_some[0]", "test_wrong"]
    assert result.stdout.str().count("takes `shot` and checks nothing: expected shot.check") >= 4


def test_a_check_in_a_clean_up_uses_its_reference(run: Run, pytester: pytest.Pytester) -> None:
    text = UNCHECKED[: UNCHECKED.index("@pytest.fixture\ndef helper")]
    pytester.makepyfile(test_sea=text + "def test_late(late): pass\n")
    for options in (("--shots-update",), ()):
        run(*options).assert_outcomes(passed=1)


@pytest.mark.parametrize("workers", [(), pytest.param(("-n", "1"), marks=pytest.mark.slow)])
def test_the_reference_of_a_check_that_is_gone_is_named(
    run: Run, pytester: pytest.Pytester, workers: tuple[str, ...]
) -> None:
    ramp = "import numpy as np\nRAMP = np.linspace(0, 1, 48).reshape(4, 4, 3)\n"
    check = "shot.check(RAMP, '{0}', by='numpy')"
    test = "def test_{0}(shot): {1}\n"
    both = "".join(test.format(name, check.format(name)) for name in ("one", "two"))
    pytester.makepyfile(test_sea=ramp + both)
    run("--shots-update").assert_outcomes(passed=2)
    other = Path("screenshots/test_sea.py/nvidia-h200")
    other.mkdir()
    for name in ("one", "gone"):
        (other / f"{name}.png").write_bytes(b"")
    lines = ["no test uses 2 references; remove:", "*numpy/two.png", "*nvidia-h200/gone.png"]
    for without in ("", test.format("two", "pass")):
        Path("test_sea.py").write_text(ramp + test.format("one", check.format("one")) + without)
        result = run(*workers)
        result.assert_outcomes(passed=1, failed=1 + bool(without))
        result.stdout.fnmatch_lines(lines)
    for arguments in (("-k", "one"), ("test_sea.py::test_one",), ("--deselect", "test_sea.py::test_two")):
        assert run(*arguments, *workers).ret == pytest.ExitCode.OK, "a part of the tests knows nothing of it"


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="this system's folders hold files alone")
@pytest.mark.parametrize("kind", ["a FIFO", "a device"])
def test_a_reference_that_is_no_file_fails_in_a_sentence(tests: Run, kind: str) -> None:
    reference = FOLDER / "numpy/ramp.png"
    reference.unlink()
    if kind == "a FIFO":
        os.mkfifo(reference)
    else:
        reference.symlink_to("/dev/zero")
    result = tests("-k", "given")
    result.assert_outcomes(failed=1, deselected=1)
    result.stdout.fnmatch_lines([f"test_slope.py/ramp: unreadable: *ramp.png: this is {kind}, not a file"])
    tests("-k", "given", "--shots-update").assert_outcomes(passed=1, deselected=1)
    assert reference.is_file() and not reference.is_symlink()


def test_references_of_removed_or_unused_test_file_fail(tests: Run) -> None:
    Path("test_other.py").write_text("def test_one(): pass\n")
    FOLDER.with_name("test_other.py").joinpath("llvmpipe").mkdir(parents=True)
    (FOLDER / "llvmpipe/seven.png").rename("screenshots/test_other.py/llvmpipe/old.png")
    result = tests("test_other.py")
    result.assert_outcomes(passed=1, failed=1)
    result.stdout.fnmatch_lines(["no test uses 1 reference; remove:", "*test_other.py/llvmpipe/old.png"])
    Path("test_slope.py").unlink()
    result = tests()
    result.stdout.fnmatch_lines(["no test uses 3 references; remove:", "*test_slope.py/numpy/ramp.png"])


@pytest.mark.slow
@pytest.mark.parametrize("dist", ["loadfile", pytest.param("each", marks=pytest.mark.slow)])
def test_workers_of_xdist_tell_what_they_wrote_and_used(
    run: Run, pytester: pytest.Pytester, dist: str
) -> None:
    """The pictures are given, so that no worker has to start a child."""
    pytest.importorskip("xdist")
    lines = ["import numpy as np"]
    lines += [
        f"def test_{n}(shot): shot.check(np.linspace(0, {n}/4, 48).reshape(4, 4, 3), 'p{n}', by='numpy')"
        for n in (1, 2, 3, 4)
    ]
    pytester.makepyfile(test_some="\n".join(lines))
    old = Path("screenshots/test_some.py/numpy/p9.png")
    old.parent.mkdir(parents=True)
    old.touch()
    result = run("-n", "2", "--dist", dist, "--shots-update")
    result.assert_outcomes(passed=8 if dist == "each" else 4, failed=1)
    result.stdout.fnmatch_lines(["no test uses 1 reference; remove:", "*numpy/p9.png", "*= shots =*"])
    result.stdout.fnmatch_lines_random(
        [f"wrote screenshots/test_some.py/numpy/p{n}.png *" for n in (1, 2, 3, 4)]
    )
    assert len(list(old.parent.glob("p?.png"))) == 5
