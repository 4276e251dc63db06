"""Screenshot tests in pytest: options, which sketches are collected, the ``shot`` fixture.

    pytest hills.toml                # one test for each shot of a sketch

    [tool.pytest.ini_options]
    shots = ["sketches/*.toml"]      # these sketches belong to the tests

    def test_evening(shot):          # a picture of any origin
        shot.check(shot.render("hills.toml", time=20.0), "evening")

The package's entry point has this module's name, so that `pytest_plugins` and ``-p`` may name
it too. It is loaded with every pytest of an environment that has the package, so it imports
next to nothing, and does nothing until there is a shot: `collect`, `checking` and `fixture`
come in then.

When all tests have run, references of test files that none of them uses are reported. A run knows which
references the tests of a file use only if it had all of its tests, and every one of them passed, or failed
only because it checked nothing: under ``-k``, ``--lf``, ``-x``, with a node id, or where a test was skipped
or failed, nothing is reported. A reference of a renderer that drew in this run is used if it was compared;
one of another renderer, if a picture of its name was checked at all. The tests may have run in several
processes; what they report is gathered where their reports come together.
"""

from __future__ import annotations

import argparse
import math
from collections import Counter, defaultdict
from collections.abc import Generator, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from playground.paths import SCREENSHOTS
from playground.verify.shots.plugin_constants import (
    CHECKED,
    FIXTURE,
    REFERENCE_RENDERER,
    REPORT,
    SHOT,
    STOOD_IN,
    SUMMARY_LINE,
    TESTS,
    UNCHANGED,
    UNCHECKED,
    UNCOMPARED,
    UNRECORDED,
    UPDATE_FAILED,
    USED,
)

if TYPE_CHECKING:
    from playground.verify.shots.fixture import ShotFixture


# ── references that no test uses ─────────────────────────────────────────────


_COUNTS: pytest.StashKey[Counter[Path]] = pytest.StashKey()


def count(item: pytest.Item) -> None:
    """Count a test of its file, before any is left out."""
    item.config.stash.setdefault(_COUNTS, Counter())[item.path] += 1


def count_tests(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Attach to each test that may use references how many tests its file has."""
    narrowed = any("::" in arg for arg in config.args) or any(
        getattr(config.option, name, False) for name in ("lf", "stepwise")
    )
    counts = config.stash.setdefault(_COUNTS, Counter())
    is_known: dict[Path, bool] = {}
    for item in items:
        uses = FIXTURE in getattr(item, "fixturenames", ())
        if uses or is_known.setdefault(item.path, references_of(item.path).is_dir()):
            item.user_properties.append((TESTS, 0 if narrowed else counts[item.path]))


def references_of(module: Path) -> Path:
    """Return the folder of a test file's references, of all renderers."""
    return module.parent / SCREENSHOTS / module.name


@dataclass
class _File:
    tests: int = 0  # in the file; 0: not known
    ended: set[str] = field(default_factory=set)  # node ids of the tests that passed, or checked nothing
    used: set[str] = field(default_factory=set)  # "renderer/name"
    unused: bool = False  # whether there are references that none of them uses


class Uses:
    """What the tests of a run have used, by the file they are in."""

    def __init__(self, root: Path, expected: str) -> None:
        self._root = root
        self._expected = expected  # slug of the renderer whose references are judged in any case
        self._files: dict[str, _File] = {}

    def add(self, report: pytest.TestReport) -> None:
        """Record a test of which it is known what it used."""
        tests = [value for name, value in report.user_properties if name == TESTS]
        unchecked = any(name == UNCHECKED for name, _ in report.user_properties)
        if not tests or not (report.passed or unchecked):
            return
        file = self._files.setdefault(report.nodeid.partition("::")[0], _File())
        file.tests = int(str(tests[0]))
        file.ended.add(report.nodeid)
        self.add_used(report)

    def add_used(self, report: pytest.TestReport) -> None:
        """Record what a test has used so far, in its fixtures' clean-up too."""
        if file := self._files.get(report.nodeid.partition("::")[0]):
            file.used.update(str(value) for name, value in report.user_properties if name == USED)

    def complete(self) -> dict[Path, set[str]]:
        """Return the test files of which every test ran and passed, with the names of what they checked.

        "references" is among them where `stale` has found some of the file.
        """
        return {
            self._root / name: {used.rpartition("/")[2] for used in file.used}
            | ({"references"} if file.unused else set())
            for name, file in self._files.items()
            if file.tests and len(file.ended) == file.tests
        }

    def stale(self) -> dict[str, str]:
        """Return, by the node id of a test that would have found it, the unused references, as a message."""
        names: dict[str, str] = {}
        for name, file in self._files.items():
            if not file.tests or len(file.ended) != file.tests:
                continue
            folder = references_of(self._root / name)
            stale: list[Path] = []
            drew = {self._expected, *(used.partition("/")[0] for used in file.used)}
            checked = {used.partition("/")[2] for used in file.used}
            for picture in sorted(folder.glob("*/*.png")):
                # dawn.png and dawn.2.png are both references of dawn
                renderer, shot = picture.parent.name, picture.name.partition(".")[0]
                if f"{renderer}/{shot}" not in file.used if renderer in drew else shot not in checked:
                    stale.append(picture)
            stale += _of_files_that_are_gone(folder.parent)
            file.unused = bool(stale)
            if stale:
                from playground.errors import counted
                from playground.paths import shown

                files = "".join(f"\n    {shown(path)}" for path in stale)
                names[f"{name}::references"] = (
                    f"no test uses {counted(len(stale), 'reference')}; remove:{files}"
                )
        return names


def _of_files_that_are_gone(home: Path) -> list[Path]:
    folders = [path for path in home.glob("*.py") if path.is_dir() and not (home.parent / path.name).exists()]
    return sorted(picture for folder in folders for picture in folder.rglob("*.png"))


# ── options, collection, summary ─────────────────────────────────────────────


_LISTED: pytest.StashKey[frozenset[Path]] = pytest.StashKey()


def pytest_addoption(parser: pytest.Parser) -> None:
    """Add the options."""
    group = parser.getgroup("shots", "screenshot tests of shaders")
    group.addoption(
        "--shots-update",
        action="store_true",
        help="write the references that are missing or do not match, and say which",
    )
    # An option of its own, for what follows --shots-update is no value of it, but a path.
    group.addoption(
        "--shots-update=failed",
        dest=UPDATE_FAILED,
        action="store_true",
        help="write only the references of those that failed when they were last run, and say which",
    )
    group.addoption(
        "--shots-output",
        metavar="DIR",
        type=Path,
        default=REPORT,
        help=f"where results go: a record of each shot, pictures of those that fail, the report "
        f"(default: {REPORT}, which git ignores)",
    )
    group.addoption(
        "--shots-report",
        action="store_true",
        help="write the report index.html also when nothing failed",
    )
    group.addoption(
        "--shots-renderer",
        metavar="NAME",
        default=REFERENCE_RENDERER,
        help="the renderer that is expected to draw, as the folders of references are named: llvmpipe "
        "(the default), nvidia-h200, …; without it shots fail if CI is set and are skipped elsewhere",
    )
    group.addoption(
        "--shots-any-renderer",
        action="store_true",
        help="where the expected renderer is missing, compare what another draws with its references: "
        "catches structural defects only",
    )
    group.addoption(
        "--shots-plain",
        action="store_true",
        help="draw every technique in its plain form, no fast variant; references are compared, not written",
    )
    group.addoption(
        "--shots-timeout",
        metavar="SECONDS",
        type=_seconds,
        default=120.0,
        help="how long a shot may take to draw before it counts as hung (default: 120)",
    )
    group.addoption(
        "--shots-pictures-url",
        metavar="URL",
        default="",
        help="where the folder of results will be found in the web: a step summary of GitHub shows "
        "the pictures of failed shots from there (default: SHOTS_PICTURES_URL of the environment)",
    )
    parser.addini(
        "shots_fallbacks",
        "whose references stand in for which renderer's, where that has none of its own: "
        "'apple-* = llvmpipe', and ', pixels' for a comparison by pixels instead of by structure",
        type="linelist",
        default=[],
    )
    parser.addini(
        "shots",
        "sketches whose shots are tests, by paths and patterns from this file's folder",
        type="linelist",
        default=[],
    )


def _seconds(text: str) -> float:
    try:
        seconds = float(text)
    except ValueError:
        seconds = math.nan
    if not 0.0 < seconds < 1e6:  # what a timer takes
        raise argparse.ArgumentTypeError(f"{text!r}: expected seconds, more than 0")
    return seconds


def pytest_configure(config: pytest.Config) -> None:
    """Register the marker, and add the sketches of the configuration to what is tested."""
    updates = config.getoption("--shots-update"), config.getoption(UPDATE_FAILED)
    if config.getoption("--shots-plain") and any(updates):
        raise pytest.UsageError("--shots-plain compares with references; --shots-update would write others")
    if all(updates):
        raise pytest.UsageError("--shots-update writes all that fail, --shots-update=failed fewer: give one")
    if config.getini("shots_fallbacks"):
        from playground.verify.shots.references import read_fallbacks

        try:
            read_fallbacks(config.getini("shots_fallbacks"))
        except ValueError as error:
            raise pytest.UsageError(f"shots_fallbacks: {error}") from None
    config.addinivalue_line("markers", "shots: compares a picture with its reference")
    config.pluginmanager.register(Results(config), "shots-results")
    if config.args_source is config.ArgsSource.ARGS or not config.getini("shots"):
        return
    listed = _listed(config)
    if config.args_source is config.ArgsSource.TESTPATHS:
        there = [config.invocation_params.dir / arg for arg in config.args]
        more = [path for path in sorted(listed) if not any(path.is_relative_to(folder) for folder in there)]
        config.args += [str(path) for path in more]


def _listed(config: pytest.Config) -> frozenset[Path]:
    """Return the sketches that the configuration names."""
    if _LISTED not in config.stash:
        base = config.inipath.parent if config.inipath else config.rootpath
        items: set[Path] = set()
        for pattern in config.getini("shots"):
            items.update(_matches(base, pattern))
        config.stash[_LISTED] = frozenset(items)
    return config.stash[_LISTED]


def _matches(base: Path, pattern: str) -> Iterator[Path]:
    whole = Path(pattern)
    if whole.is_absolute():
        base, pattern = Path(whole.anchor), str(whole.relative_to(whole.anchor))
    try:
        paths = list(base.glob(pattern))
    except (ValueError, NotImplementedError, IndexError) as error:
        raise pytest.UsageError(f"shots: {pattern!r} is no pattern of files ({error})") from None
    files = [path / "sketch.toml" if path.is_dir() else path for path in paths]
    files = [path for path in files if path.suffix == ".toml" and path.is_file()]
    if not files:
        raise pytest.UsageError(
            f"shots: no sketch (a .toml, or a folder with sketch.toml) matches {pattern!r} in {base}"
        )
    yield from files


def pytest_collect_file(file_path: Path, parent: pytest.Collector) -> pytest.Collector | None:
    """Collect a sketch that the command line or the configuration names."""
    if file_path.suffix != ".toml":
        return None
    config, session = parent.config, parent.session
    named = session.isinitpath(file_path)
    if file_path.name == "sketch.toml" and config.args_source is config.ArgsSource.ARGS:
        named = named or session.isinitpath(file_path.parent)
    if not named and not (config.getini("shots") and file_path in _listed(config)):
        return None
    from playground.verify.shots.collect import SketchFile

    return SketchFile.from_parent(parent, path=file_path)


def pytest_itemcollected(item: pytest.Item) -> None:
    """Count the tests of a file."""
    count(item)


@pytest.hookimpl(tryfirst=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Mark the tests in Python that compare pictures, for ``-m shots``."""
    for item in items:
        if FIXTURE in getattr(item, "fixturenames", ()):
            item.add_marker("shots")
    count_tests(config, items)


@pytest.fixture
def shot(request: pytest.FixtureRequest) -> Iterator[ShotFixture]:
    """Draw sketches in a process of their own, and compare pictures with their references.

    ``shot.render("hills.toml")`` gives a frame; ``shot.check(frame, "evening")`` fails the
    test, when that ends, unless it is the reference in ``screenshots/<test file>/<renderer>/evening.png``
    in the test file's folder.
    """
    from playground.verify.shots.fixture import ShotFixture

    fixture = ShotFixture(request.node)
    yield fixture
    fixture.finish()


class Results:
    """Gathers what tests report, here or in workers of xdist; judges, writes and prints it at the end."""

    def __init__(self, config: pytest.Config) -> None:
        self.config = config
        self.lines: list[str] = []
        self.notified: defaultdict[str, list[str]] = defaultdict(list)  # what tests report, by what it is
        self.properties_of_shots: list[dict[str, str]] = []  # of each checked shot: see `results`
        self.uses = Uses(config.rootpath, config.getoption("--shots-renderer"))

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Record a finished test, which may come from another process."""
        if report.when == "teardown":
            self.uses.add_used(report)
        if report.when != "call":
            return
        self.uses.add(report)
        for name, value in report.user_properties:
            self.notified[name].append(str(value))
            if name == SHOT:
                self.properties_of_shots.append({})
            if name == SHOT or name.startswith(f"{SHOT}."):
                self.properties_of_shots[-1][name] = str(value)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtestloop(self, session: pytest.Session) -> Generator[None, object, object]:
        """When all tests have run, report the references that none of them uses, as failed tests."""
        result = yield
        if not hasattr(self.config, "workerinput"):
            for node, message in self.uses.stale().items():
                from playground.verify.shots.recording import record_stale

                path = self.config.rootpath / node.partition("::")[0]
                properties = record_stale(self.config, path, message)
                location = (node.partition("::")[0], None, "references")
                report = pytest.TestReport(
                    node, location, {"shots": 1}, "failed", message, "call", user_properties=properties
                )
                session.testscollected += 1  # or pytest's progress goes beyond 100 %
                self.config.hook.pytest_runtest_logreport(report=report)
        return result

    def pytest_sessionfinish(self) -> None:
        """Write the report, where there is something to look at or it is wanted."""
        notified = self.notified
        if not (notified[CHECKED] or notified[UNCOMPARED]) or hasattr(self.config, "workerinput"):
            return
        self.lines += notified[SUMMARY_LINE]
        if notified[UNCHANGED]:
            self.lines.append(f"left {len(notified[UNCHANGED])} as they were, for they match")
        self.lines += [f"{count} {how}" for how, count in Counter(notified[STOOD_IN]).items()]
        for why, count in Counter(notified[UNCOMPARED]).items():
            shots = "1 shot was" if count == 1 else f"{count} shots were"
            self.lines.append(f"{shots} not compared: {why}")
        if self.config.getoption(UPDATE_FAILED) and not any(line.startswith("wrote") for line in self.lines):
            self.lines.append("--shots-update=failed wrote nothing: no shot failed that had failed before")
        if notified[UNRECORDED]:
            self.lines += dict.fromkeys(notified[UNRECORDED])
            return
        from playground.verify.shots.recording import finish
        from playground.verify.shots.report import summarise
        from playground.verify.shots.verdicts import verdict_on

        folder = self.config.invocation_params.dir / self.config.getoption("--shots-output")
        if message := summarise(
            self.properties_of_shots, folder, self.config.getoption("--shots-pictures-url")
        ):
            self.lines.append(message)
        failed = not all(verdict_on(word).passes for word in notified[CHECKED])
        requested = failed or self.config.getoption("--shots-report")
        self.lines += finish(self.config, self.uses.complete(), requested)

    def pytest_terminal_summary(self, terminalreporter: pytest.TerminalReporter) -> None:
        """Print what was written, what was left alone, and where the results are."""
        if self.lines:
            terminalreporter.section("shots")
            for line in self.lines:
                terminalreporter.line(line)
