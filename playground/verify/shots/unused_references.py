"""Find references of test files that no test uses any more, in a run that could know.

A run knows which references the tests of a file use only if it had all of its tests, and
every one of them passed, or failed only because it checked nothing: under ``-k``, ``--lf``, ``-x``, with
a node id, or where a test was skipped or failed, nothing is reported. A reference of a renderer that
drew in this run is used if it was compared; one of another renderer, if a picture of its name was
checked at all. The tests may have run in several processes; what they report is gathered where their
reports come together.

It reads no pictures, and is loaded with every pytest: it imports next to nothing.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from playground.paths import SCREENSHOTS
from playground.verify.shots.plugin_constants import FIXTURE, TESTS, UNCHECKED, USED

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
