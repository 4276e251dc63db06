"""Find references of test files that no test uses any more, in a run that could know.

A run knows which references the tests of a file use only if it had all of its tests, and
every one of them passed: under ``-k``, ``--lf``, ``-x``, with a node id, or where a test was
skipped or failed, nothing is reported. Of the references, only those of renderers that drew in
this run are judged. The tests may have run in several processes; what they report
is gathered where their reports come together.

It reads no pictures, and is loaded with every pytest: it imports next to nothing.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path

import pytest

from playground.shots.plugin_constants import SCREENSHOTS, TESTS, USED

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
    known: dict[Path, bool] = {}
    for item in items:
        uses = "shot" in getattr(item, "fixturenames", ())
        if uses or known.setdefault(item.path, references_of(item.path).is_dir()):
            item.user_properties.append((TESTS, 0 if narrowed else counts[item.path]))


def references_of(module: Path) -> Path:
    """Return the folder of a test file's references, of all renderers."""
    return module.parent / SCREENSHOTS / module.name


@dataclass
class _File:
    tests: int = 0  # in the file; 0: not known
    passed: set[str] = field(default_factory=set)  # node ids
    used: set[str] = field(default_factory=set)  # "renderer/name"
    unused: bool = False  # whether there are references that none of them uses


class Uses:
    """What the tests of a run have used, by the file they are in."""

    def __init__(self, root: Path, expected: str) -> None:
        self._root = root
        self._expected = expected  # slug of the renderer whose references are judged in any case
        self._files: dict[str, _File] = {}

    def add(self, report: pytest.TestReport) -> None:
        """Record a test that has passed."""
        tests = [value for name, value in report.user_properties if name == TESTS]
        if not tests or not report.passed:
            return
        file = self._files.setdefault(report.nodeid.partition("::")[0], _File())
        file.tests = int(str(tests[0]))
        file.passed.add(report.nodeid)
        file.used.update(str(value) for name, value in report.user_properties if name == USED)

    def complete(self) -> dict[Path, set[str]]:
        """Return the test files of which every test ran and passed, with the names of what they checked.

        "references" is among them where `stale` has found some of the file.
        """
        return {
            self._root / name: {used.rpartition("/")[2] for used in file.used}
            | ({"references"} if file.unused else set())
            for name, file in self._files.items()
            if file.tests and len(file.passed) == file.tests
        }

    def stale(self) -> dict[str, str]:
        """Return, by the node id of a test that would have found it, the unused references, as a sentence."""
        found: dict[str, str] = {}
        for name, file in self._files.items():
            if not file.tests or len(file.passed) != file.tests:
                continue
            folder = references_of(self._root / name)
            stale: list[Path] = []
            for renderer in {self._expected, *(used.partition("/")[0] for used in file.used)}:
                # dawn.png and dawn.2.png are both references of dawn
                pictures = sorted((folder / renderer).glob("*.png"))
                stale += [p for p in pictures if f"{renderer}/{p.name.partition('.')[0]}" not in file.used]
            stale += _of_files_that_are_gone(folder.parent)
            file.unused = bool(stale)
            if stale:
                from playground.errors import counted
                from playground.paths import shown

                files = "".join(f"\n    {shown(path)}" for path in stale)
                found[f"{name}::references"] = (
                    f"no test uses {counted(len(stale), 'reference')}; remove:{files}"
                )
        return found


def _of_files_that_are_gone(home: Path) -> list[Path]:
    folders = [path for path in home.glob("*.py") if path.is_dir() and not (home.parent / path.name).exists()]
    return sorted(picture for folder in folders for picture in folder.rglob("*.png"))
