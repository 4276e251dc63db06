"""Collect a sketch's shots as tests, one each, and one for its references.

``hills.toml::morning``: the picture of a shot is one of its references.
``hills.toml::references``: no reference is there that no shot uses.
``hills.toml::sketch``: only where it cannot be loaded, or promises no picture; says so.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from playground import paths
from playground.data.image_files import read_texts
from playground.errors import DataError, PlaygroundError, counted, nearest
from playground.paths import shown
from playground.sketch.find import home_of
from playground.sketch.load import load_with
from playground.sketch.model import Graph, Shot, Sketch
from playground.sketch.techniques import Techniques
from playground.verify.shots.checking import checker_of
from playground.verify.shots.recording import references_name
from playground.verify.shots.references import FOLDER, stale_references
from playground.verify.shots.suite import ShotCase

_TECHNIQUES: pytest.StashKey[Techniques] = pytest.StashKey()
_HOMES: pytest.StashKey[set[Path]] = pytest.StashKey()


class SketchFile(pytest.File):
    """A sketch, whose shots are tests."""

    def collect(self) -> Iterator[pytest.Item]:
        """Yield a test for each shot, and one for the references; one that fails for what is no sketch."""
        try:
            techniques = self.config.stash.setdefault(_TECHNIQUES, Techniques())  # most sketches share theirs
            sketch = load_with(techniques, self.path)
        except PlaygroundError as error:
            yield from self._failing(str(error))
            return
        if not sketch.shots:
            yield from self._failing(
                f"{shown(self.path)}: this sketch promises no picture; add a [[shot]] table, or leave it out"
            )
        for shot in sketch.shots:
            item = ShotItem.from_parent(self, name=shot.name, case=ShotCase(sketch, shot))
            marks = _marks(self.config)
            for mark in shot.marks:
                if mark not in marks and self.config.getoption("strict_markers", False):
                    item.trouble = f"{shown(self.path)}:{shot.line}: marks: there is no marker '{mark}'"
                    item.trouble += nearest(mark, marks)
                else:
                    item.add_marker(mark)
            yield item
        name = references_name({shot.name for shot in sketch.shots})
        yield ReferencesItem.from_parent(self, name=name, sketch=sketch)

    def _failing(self, message: str) -> Iterator[pytest.Item]:
        """Yield the test that says what is wrong, under each name that was given."""
        arguments = [arg.partition("::") for arg in self.config.args]
        here = self.config.invocation_params.dir
        names = [name for file, _, name in arguments if name and here / file == self.path]
        for name in dict.fromkeys(names or ["sketch"]):
            yield FailingItem.from_parent(self, name=name, message=message)


class SketchItem(pytest.Item):
    """A test of a sketch, on one line of it."""

    line = 0  # from 0
    title = ""

    def __init__(self, **named: object) -> None:
        super().__init__(**named)  # type: ignore[arg-type]
        self.add_marker("shots")

    def reportinfo(self) -> tuple[Path, int, str]:
        """Return where it is written, the line from 0, and its name."""
        return self.path, self.line, self.title or self.name


class ShotItem(SketchItem):
    """The test of one shot."""

    def __init__(self, *, case: ShotCase, **named: object) -> None:
        super().__init__(**named)
        self.case, self.line, self.title = case, max(case.shot.line - 1, 0), str(case)
        self.trouble = ""  # what is wrong with it as a test

    def runtest(self) -> None:
        """Draw it and compare it."""
        if self.trouble:
            checker_of(self.config).fail(self, self.case, self.trouble)
        checker_of(self.config).shot(self, self.case)


class ReferencesItem(SketchItem):
    """The test that finds unused references."""

    def __init__(self, *, sketch: Sketch, **named: object) -> None:
        super().__init__(**named)
        self.sketch, self.title = sketch, f"references of {sketch.name}"
        try:
            homes = self.config.stash.setdefault(_HOMES, set())
            home = home_of(sketch)
            # The first sketch of a folder also looks for pictures of sketches that are gone.
            self.first_of_home = home not in homes
            homes.add(home)
        except DataError:
            self.first_of_home = False

    def runtest(self) -> None:
        """Fail for references that no shot uses."""
        checker, case = checker_of(self.config), ShotCase(self.sketch, Shot(self.name))
        try:
            stale = stale_references([self.sketch])
            home = home_of(self.sketch)
        except DataError as error:
            checker.fail(self, case, str(error))
        own = [p for p in stale if p.relative_to(home).parts[0] == self.sketch.name]
        if self.first_of_home:
            own += [p for p in stale if p not in own and _is_reference(p, home)]
        if own:
            files = "".join(f"\n    {shown(path)}" for path in sorted(own))
            checker.fail(self, case, f"no shot uses {counted(len(own), 'reference')}; remove:{files}")
        checker.recorder.forget(self, case)


class FailingItem(SketchItem):
    """A test that only says what is wrong with a sketch."""

    def __init__(self, *, message: str, **named: object) -> None:
        super().__init__(**named)
        self.message = message

    def runtest(self) -> None:
        """Fail."""
        name = self.path.parent.name if self.path.name == "sketch.toml" else self.path.stem
        sketch = Sketch(name, str(self.path), str(self.path.parent), Graph(name, str(self.path), ()))
        shot = Shot(re.sub(r"[./\\\0]", "-", self.name))
        checker_of(self.config).fail(self, ShotCase(sketch, shot), self.message)


def _is_reference(path: Path, home: Path) -> bool:
    """Return whether a picture is a reference of a sketch; other pictures may be in the same folder."""
    folder, *others = path.relative_to(home).parts
    if folder.endswith(".py"):  # of a test file
        return False
    if paths.CHECKOUT is not None and home == paths.CHECKOUT / FOLDER:
        return True
    try:
        return len(others) == 2 and read_texts(path).get("sketch") == folder
    except DataError:
        return False


def _marks(config: pytest.Config) -> set[str]:
    return {line.split(":")[0].split("(")[0].strip() for line in config.getini("markers")}
