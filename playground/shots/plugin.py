"""Hold sketches to their shots in pytest: options, the ``shots`` fixture, what a failure prints.

    pytest_plugins = ["playground.shots.plugin"]            # in the conftest.py at the top

    CASES = shots_of(["mine.toml"])

    @pytest.mark.parametrize("case", CASES, ids=str)
    def test_shot(case, shots):
        shots.check(case)

Nothing passes in silence: a missing reference fails, and so does a missing reference
renderer where ``CI`` is set; on a person's machine that is a skip that gives its reason.
Pictures of a failure go to pytest's temporary folder, or to ``--shots-output``.

It collects nothing by itself, and has one tier: the reference renderer, exactly.
"""

from __future__ import annotations

import os
import shlex
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NoReturn

import pytest

from playground.errors import ContextError, PlaygroundError, counted
from playground.gpu.context import ContextInfo
from playground.paths import shown
from playground.shots.references import REFERENCE_RENDERER, drawn_by, stale_references, write_reference
from playground.shots.studio import Studio
from playground.shots.suite import Outcome, ShotCase, check, save_pictures
from playground.sketch.model import Sketch

_SAID = "shots"  # the user property that carries a line for the summary, from a worker of xdist too


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the two options."""
    group = parser.getgroup("shots", "pictures compared with their references")
    group.addoption("--shots-update", action="store_true", help="rewrite the references that do not match")
    group.addoption(
        "--shots-output",
        metavar="DIR",
        type=Path,
        help="where the pictures of a failure go (default: pytest's temporary folder)",
    )


@pytest.fixture(scope="session")
def shots_studio() -> Iterator[Studio]:
    """Give the child process that takes the pictures; it starts with the first of them."""
    with Studio() as studio:
        yield studio


@pytest.fixture
def shots(
    request: pytest.FixtureRequest, shots_studio: Studio, tmp_path_factory: pytest.TempPathFactory
) -> Shots:
    """Give what checks shots for this test."""
    output: Path | None = request.config.getoption("--shots-output")
    return Shots(request.node, shots_studio, output or tmp_path_factory.getbasetemp() / "shots")


class Shots:
    """Checks shots for one test, which it fails or skips in words."""

    def __init__(self, node: pytest.Item, studio: Studio, output: Path) -> None:
        self.node = node
        self.studio = studio
        self.output = output  # folder for the pictures of a failure
        self.updating: bool = node.config.getoption("--shots-update")

    def check(self, case: ShotCase) -> None:
        """Take a shot; fail the test unless a reference matches, or ``--shots-update`` writes one."""
        renderer = self._reference_renderer()
        try:
            outcome = check(case, self.studio.take(case), renderer)
            if outcome.ok:
                return
            if self.updating and outcome.word not in ("blank", "nan", "gl-error"):
                self._write(outcome)
                return
            message = self._explained(outcome)
        except PlaygroundError as error:
            message = f"{case}: {error}"
        pytest.fail(message, pytrace=False)

    def check_no_stale(self, sketches: Iterable[Sketch]) -> None:
        """Fail the test if there are references, of any renderer, that no shot of these sketches uses."""
        stale = stale_references(sketches)
        if stale:
            files = "".join(f"\n    {shown(path)}" for path in stale)
            pytest.fail(f"no shot uses {counted(len(stale), 'reference')}; remove:{files}", pytrace=False)

    def _reference_renderer(self) -> ContextInfo:
        try:
            renderer = self.studio.renderer
        except ContextError as error:
            self._without(str(error))
        except PlaygroundError as error:
            pytest.fail(str(error), pytrace=False)
        if renderer.slug != REFERENCE_RENDERER:
            self._without(f"OpenGL gave {renderer.renderer}")
        return renderer

    def _without(self, found: str) -> NoReturn:
        message = f"the reference renderer is missing: shots are compared on {REFERENCE_RENDERER}; {found}"
        if os.environ.get("CI", "").lower() not in ("", "0", "false"):
            pytest.fail(message, pytrace=False)
        pytest.skip(message)

    def _write(self, outcome: Outcome) -> None:
        case = outcome.case
        written, removed = write_reference(
            case.sketch, case.shot.name, outcome.renderer, outcome.frame.array, outcome.fingerprint.drawn
        )
        self._say(f"wrote {shown(written)}  ({outcome.sentence})")
        for path in removed:
            self._say(f"removed {shown(path)}  (it let the picture before this one pass)")

    def _say(self, line: str) -> None:
        self.node.user_properties.append((_SAID, line))

    def _explained(self, outcome: Outcome) -> str:
        lines = [f"{outcome.case}: {outcome.sentence}", f"    reference   {shown(outcome.path)}"]
        files = save_pictures(outcome, self.output)
        lines += [f"    {word:<11} {path.absolute()}" for word, path in files.items()]
        if outcome.other_build:
            lines.append(f"    drawn by    {drawn_by(outcome.renderer)}")
            lines.append(f"    reference   by {outcome.other_build}")
        if outcome.word not in ("blank", "nan", "gl-error"):
            lines.append(f"    accept it   pytest --shots-update {shlex.quote(self.node.nodeid)}")
        return "\n".join(lines)


def pytest_configure(config: pytest.Config) -> None:
    """Gather, for this session, what the tests say."""
    config.pluginmanager.register(_Summary(), "shots-summary")


class _Summary:
    """Gathers what tests said, from this process or from workers, and prints it at the end."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        if report.when == "call":
            self.lines += [str(value) for name, value in report.user_properties if name == _SAID]

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        if self.lines:
            terminalreporter.section("shots")
            for line in self.lines:
                terminalreporter.line(line)
