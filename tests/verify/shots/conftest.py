"""A tiny sketch of a user's own, and pytest run on it inside pytest, with one child for all runs."""

from __future__ import annotations

import email.parser  # noqa: F401
import shutil
import sys
from collections.abc import Callable, Iterator
from pathlib import Path

import PIL.Image
import PIL.ImageOps
import pytest

# A run of pytest inside pytest forgets the modules that it imports first, so these are imported here.
from playground.verify.shots import checking, collect, fixture  # noqa: F401
from playground.verify.shots.first_difference import Difference, Search
from playground.verify.shots.references import Fingerprint
from playground.verify.shots.suite import RenderedShot, RendererProcess, ShotCase
from playground.verify.shots.verdicts import VERDICTS

WORDS_FOR_PICTURES = VERDICTS.keys() - {"crash", "hang", "error"}

# What drew a reference, as one build of Mesa says it.
OURS = Fingerprint(
    renderer="llvmpipe (LLVM 15.0.6, 256 bits)",
    version="4.5 Mesa 22.3.6",
    vendor="Mesa/X.org",
    mesa="22.3.6",
    llvm="15.0.6",
    cpu="GenuineIntel",
    simd="avx fma f16c",
    drawn="ab12",
    size="64x32",
    tool="tool 1",
)

KERNEL = """// terrain.glsl -- a slope.
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
use = "./terrain"

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

Run = Callable[..., pytest.RunResult]


@pytest.fixture(scope="session")
def warm_renderer() -> Iterator[RendererProcess]:
    """Give one process that renders for all runs of pytest inside pytest: starting it takes the most time."""
    PIL.Image.preinit()
    with RendererProcess() as process:
        yield process


class Lent:
    """A renderer process that is not the borrower's to close; a few shots do not come off."""

    def __init__(self, process: RendererProcess, ends: dict[str, Exception]) -> None:
        self._process = process
        self._ends = ends  # by shot: what comes instead of a picture
        self.renderer = process.renderer

    def render(self, case: ShotCase) -> RenderedShot:
        if case.shot.name in self._ends:
            raise self._ends[case.shot.name]
        return self._process.render(case)

    def locate(self, search: Search) -> Difference:
        return self._process.locate(search)

    def printed(self) -> str:
        return self._process.printed()

    def close(self) -> None:
        pass


@pytest.fixture
def ends() -> dict[str, Exception]:
    """Give what a test fills with what comes instead of a picture, by shot."""
    return {}


@pytest.fixture
def run(
    pytester: pytest.Pytester,
    monkeypatch: pytest.MonkeyPatch,
    warm_renderer: RendererProcess,
    ends: dict[str, Exception],
) -> Run:
    """Give what runs pytest in a folder with the tiny sketch."""
    if not sys.platform.startswith("linux"):
        pytest.skip("the reference renderer, Mesa's llvmpipe, is chosen by name on Linux")
    for variable in ("CI", "GALLIUM_DRIVER", "PYTEST_ADDOPTS", "PYTEST_XDIST_TESTRUNUID"):
        monkeypatch.delenv(variable, raising=False)
    monkeypatch.setattr(checking, "RendererProcess", lambda *_: Lent(warm_renderer, ends))
    Path("terrain.glsl").write_text(KERNEL)
    Path("slope.toml").write_text(SKETCH)
    fixed = ("-p", "playground.verify.shots.plugin", "-p", "no:cacheprovider", "-W", "error", "-ra")
    return lambda *arguments: pytester.runpytest_inprocess(*fixed, *arguments)


@pytest.fixture(scope="session")
def written_references() -> dict[str, dict[Path, bytes]]:
    """Give what `write_references` keeps: the references of each sketch or test file, by path."""
    return {}


@pytest.fixture
def write_references(run: Run, written_references: dict[str, dict[Path, bytes]]) -> Callable[[str, int], Run]:
    """Give what writes the references of a file: by a run of so many tests, later times by copying them."""

    def write(file: str, tests: int) -> Run:
        if file not in written_references:
            run(file, "--shots-update").assert_outcomes(passed=tests)
            paths = Path("screenshots").rglob("*.png")
            written_references[file] = {path: path.read_bytes() for path in paths}
            shutil.rmtree("shots-report")
        for path, data in written_references[file].items():
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_bytes(data)
        return run

    return write


@pytest.fixture
def accepted(write_references: Callable[[str, int], Run]) -> Run:
    """Give what runs pytest on the tiny sketch, with references that match."""
    return write_references("slope.toml", 3)


@pytest.fixture
def edit() -> Callable[[str, str, str], None]:
    """Give what replaces a part of a file that is there."""

    def edited(file: str, old: str, new: str) -> None:
        text = Path(file).read_text()
        assert old in text
        Path(file).write_text(text.replace(old, new))

    return edited
