"""Write a record of each checked shot into the results folder of this run of pytest."""

from __future__ import annotations

import os
import shlex
import time
from collections.abc import Collection, Iterator, Mapping
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.errors import DataError
from playground.paths import SCREENSHOTS, program, shown
from playground.sketch.find import home_of
from playground.verify.shots.judge import OTHER_BUILD, OTHER_RENDERER, SAME_BUILD, STRUCTURE_ONLY, frame_size
from playground.verify.shots.names import forget_claims
from playground.verify.shots.plugin_constants import CHECKED, STOOD_IN, UNRECORDED
from playground.verify.shots.references import accepted, reference_texts
from playground.verify.shots.report import NAME, write_report
from playground.verify.shots.results import (
    FOLDER,
    FRAMES,
    PICTURES,
    Actual,
    CheckRun,
    Expected,
    Record,
    Rules,
    clean,
    digests_of,
    drop,
    file_of,
    place_of,
    properties_of,
    read_result,
    records_in,
    write_result,
)
from playground.verify.shots.suite import Outcome, RenderedShot, ShotCase, images_of
from playground.verify.shots.verdicts import PASSED, VERDICTS

_CATCHES = {
    SAME_BUILD: "The same build drew both: any change of more than one level is found",
    OTHER_BUILD: "Another build drew the reference: changes of more than three levels are found, and smaller "
    "ones where they are many or crowded",
    OTHER_RENDERER: STRUCTURE_ONLY,
}


class Recorder:
    """Writes the records of one process into the folder that all of them fill."""

    def __init__(self, config: pytest.Config) -> None:
        self.root = config.invocation_params.dir
        self.folder: Path = self.root / config.getoption("--shots-output")
        # The same in all processes: xdist gives its workers one.
        self.run = os.environ.get("PYTEST_XDIST_TESTRUNUID") or os.urandom(16).hex()
        self._earlier: dict[str, list[Record]] = {}  # by place: records that were there at the first look

    def record(
        self,
        node: pytest.Item,
        outcome: Outcome,
        seconds: float,
        command: str,
        stands_in: str = "",
        traced: tuple[str, ...] = (),
    ) -> str:
        """Write the record of a picture that was compared, with the pictures unless it passed.

        ``stands_in`` says whose references stood in for those of the picture's renderer, ``traced`` where its
        run parts from the reference's.
        Where it cannot be written, that is returned, a message, and goes to the summary; else "".
        """
        comparison, perceived, reference = outcome.comparison, outcome.perceived, outcome.reference
        name, own = outcome.case.shot.name, outcome.renderer.slug
        frame = outcome.frame if isinstance(outcome.frame, RenderedShot) else None
        record = self._new_record(node, outcome.case, outcome.word, outcome.message, seconds)
        try:
            references = digests_of(accepted(outcome.case.sketch, name, own))
        except DataError:  # the outcome says so, and whoever accepts it is told again
            references = {}
        record = replace(
            record,
            renderer=own,
            place=perceived.place if perceived else comparison.position,
            numbers=_numbers(outcome),
            fingerprint=outcome.differences,
            traced=traced,
            rules=Rules(
                tier=outcome.tier,
                tolerance=str(outcome.tolerance or ""),
                tolerated=("needed" if outcome.tolerated else "not needed")
                if outcome.tolerance and outcome.ok
                else "",
                masked=outcome.masked,
                tone=frame.tone if frame else "",
                catches=_CATCHES.get(outcome.tier, ""),
            ),
            expected=replace(
                record.expected,
                reference=_from(self.root, reference.path) if reference else "",
                stands_in=stands_in,
                compared=reference.path.name if reference else "",
                references=references,
                size=comparison.expected_size,
                texts=reference.text if reference else {},
            ),
            actual=Actual(
                size=comparison.size,
                texts=reference_texts(outcome.fingerprint, outcome.case.sketch.name, name),
            ),
            run=replace(record.run, command=command),
        )
        if stands_in:
            node.user_properties.append((STOOD_IN, stands_in))
        return self._write(node, outcome.case, record, {} if outcome.ok else images_of(outcome))

    def record_none(self, node: pytest.Item, case: ShotCase, word: str, message: str, seconds: float) -> str:
        """Write the record of a shot of which there is no picture; returns what `record` does."""
        first, _, rest = message.partition("\n")
        record = replace(self._new_record(node, case, word, first, seconds), error=rest)
        return self._write(node, case, record, {})

    def failed(self) -> frozenset[str]:
        """Return what failed when it was last checked, before this run, as `name_of` gives it."""
        earlier = [record for record in records_in(self.folder) if record.run.name != self.run]
        return frozenset(r.name for r in earlier if r.run.root == str(self.root) and not r.ok)

    def name_of(self, case: ShotCase) -> str:
        """Return what a shot's record is called: its folder in the results, and its own name."""
        return f"{self._place(case)}/{case.shot.name}"

    def forget(self, node: pytest.Item, case: ShotCase) -> None:
        """Remove the record of what failed without a picture, if there is one: it is not so any more."""
        node.user_properties.append((CHECKED, PASSED))
        try:
            before = self._before(self._place(case), case.shot.name)
            if before:
                drop(self.folder, before)
        except (DataError, OSError):  # nothing can be written or removed
            pass

    def forget_earlier(self, node: pytest.Item, case: ShotCase) -> None:
        """Remove what a test has left in earlier runs: it runs again, and may check other pictures."""
        try:
            folder_name = self._place(case)
            own = [record for record in self._earlier[folder_name] if record.run.node == typed(node)]
            self._earlier[folder_name] = [
                record for record in self._earlier[folder_name] if record not in own
            ]
            for record in own:
                # Another test may have left one of that name meanwhile.
                if record.run.root == str(self.root) and self._before(folder_name, record.shot) == record:
                    drop(self.folder, record)
        except (DataError, OSError):
            pass

    def pictures(self, case: ShotCase) -> Iterator[tuple[str, Path]]:
        """Yield word and file of each picture that a failed shot has left."""
        try:
            folder_name = self._place(case)
        except (DataError, OSError):
            return
        for word in PICTURES:
            path = self.folder / folder_name / f"{case.shot.name}.{word}.png"
            if path.exists():
                yield word, path

    def place(self, case: ShotCase) -> Path | None:
        """Return the folder of a sketch's records; None where there can be none."""
        try:
            return self.folder / self._place(case)
        except (DataError, OSError):
            return None

    def _write(
        self, node: pytest.Item, case: ShotCase, record: Record, pictures: dict[str, NDArray[np.uint8]]
    ) -> str:
        node.user_properties.append((CHECKED, record.word))
        try:
            folder_name = self._place(case)
            record = replace(record, folder="" if folder_name == record.sketch else folder_name)
            before = self._before(folder_name, record.shot)
            if (
                before
                and before.run.name == record.run.name
                and before.run.node != record.run.node
                and not before.ok
            ):
                # Two tests check pictures of one name: what passed may not hide what failed.
                if record.ok:
                    return ""
                record = replace(record, message=f"{record.message}; {before.run.node} failed as well")
            written = write_result(self.folder, record, pictures)
            node.user_properties += properties_of(self.folder, written)
        except (DataError, OSError) as error:
            message = _unrecorded(error)
            node.user_properties.append((UNRECORDED, message))
            return message
        return ""

    def _before(self, folder_name: str, shot: str) -> Record | None:
        try:
            return read_result(self.folder / folder_name / f"{shot}.json")
        except DataError:  # none, or one of another version
            return None

    def _place(self, case: ShotCase) -> str:
        """Return the folder of a sketch's records; at the first look, remove those of shots that are gone."""
        home = _home(case, self.root)
        name = case.sketch.name
        folder_name = place_of(self.folder, name, self.root / home) if home else name
        if folder_name not in self._earlier:
            there = list(records_in(self.folder, folder_name))
            shots = {shot.name for shot in case.sketch.shots}
            shots |= {references_name(shots)} if shots else set()
            own = Path(case.sketch.file)
            gone = [r for r in there if shots and r.shot not in shots and file_of(r, self.root) == own]
            for record in gone:
                drop(self.folder, record)
            self._earlier[folder_name] = [r for r in there if r.run.name != self.run and r not in gone]
        return folder_name

    def _new_record(
        self, node: pytest.Item, case: ShotCase, word: str, message: str, seconds: float
    ) -> Record:
        return Record(
            sketch=case.sketch.name,
            shot=case.shot.name,
            word=word,
            message=message,
            expected=Expected(home=_home(case, self.root)),
            run=CheckRun(
                root=str(self.root), node=typed(node), seconds=seconds, when=time.time(), name=self.run
            ),
        )


def typed(node: pytest.Item) -> str:
    """Return a test's id as one types it in the folder where pytest was started.

    Pytest's own begins at its root folder, which may be another.
    """
    _, parted, rest = node.nodeid.partition("::")
    return _from(node.config.invocation_params.dir, node.path) + parted + rest


def _from(root: Path, path: Path) -> str:
    """Return a path from a folder if it is inside, else whole."""
    return path.relative_to(root).as_posix() if path.is_relative_to(root) else str(path)


def references_name(shots: Collection[str]) -> str:
    """Return the name of the test that finds unused references, which is none of these shots'."""
    return "references" if "references" not in shots else "references of all shots"


def _home(case: ShotCase, root: Path) -> str:
    try:
        return _from(root, home_of(case.sketch))
    except DataError:
        return ""


def _numbers(outcome: Outcome) -> dict[str, float]:
    comparison = outcome.comparison
    if not VERDICTS[comparison.verdict].measured:
        return {}
    fraction, labels = comparison.fraction, getattr(outcome.frame, "labels", ())
    if labels:  # of its frames, without the cells of the strip that are left over
        width, height = frame_size(outcome.frame.array, len(labels))
        fraction = comparison.over / (width * height * len(labels) - comparison.hidden)
    numbers: dict[str, float] = {
        "largest difference, levels of 255": comparison.most,
        f"pixels over {comparison.tolerance}": comparison.over,
        f"pixels over {comparison.tolerance}, %": 100.0 * fraction,
    }
    if labels:
        numbers = {FRAMES: len(labels)} | numbers
    if comparison.hidden:
        numbers["pixels masked"] = comparison.hidden
    if outcome.crowd is not None:
        numbers["pixels in the most crowded window"] = outcome.crowd.count
    if outcome.perceived is not None:
        numbers |= {"FLIP, mean": outcome.perceived.mean, "FLIP, worst tile": outcome.perceived.tile}
    return numbers


def record_stale(config: pytest.Config, path: Path, message: str) -> list[tuple[str, object]]:
    """Write a record that a test file has unused references; return the user properties of its report."""
    recorder = Recorder(config)
    first, _, rest = message.partition("\n")
    try:
        home = path.parent / SCREENSHOTS
        folder_name = place_of(recorder.folder, path.name, home)
        # Of the same run as what its tests have left, which may have run in other processes.
        runs = {record.run.when: record.run.name for record in records_in(recorder.folder)}
        record = Record(
            sketch=path.name,
            shot="references",
            word="error",
            message=first,
            error=rest,
            folder="" if folder_name == path.name else folder_name,
            expected=Expected(home=str(home)),
            run=CheckRun(
                root=str(recorder.root),
                node=f"{_from(recorder.root, path)}::references",
                when=time.time(),
                name=runs[max(runs)] if runs else "",
            ),
        )
        write_result(recorder.folder, record, {})
    except (DataError, OSError) as error:
        return [(CHECKED, "error"), (UNRECORDED, _unrecorded(error))]
    return [(CHECKED, "error")]


def finish(config: pytest.Config, complete: Mapping[Path, set[str]], requested: bool) -> list[str]:
    """Remove the records that mean nothing any more, see that no page shows them, and report if it is wanted.

    ``complete`` has what was checked by test files of which every test ran and passed. Returns
    what there is to say.
    """
    recorder = Recorder(config)
    page = recorder.folder / NAME
    try:
        forget_claims(recorder.folder)
        clean(recorder.folder, recorder.root, complete)
        if not requested and not page.exists():
            return []
        if not any(recorder.folder.glob("*/*.json")):
            page.unlink(missing_ok=True)
            return []
    except OSError as error:
        return [_unrecorded(error)]
    lines = report(recorder.folder)
    return lines if requested else []


def _unrecorded(error: Exception) -> str:
    return f"no results are recorded: {error}; --shots-output names another folder"


def report(folder: Path) -> list[str]:
    """Write the report on a folder of results, and say where it is and how to look at it."""
    try:
        lines = [f"report: {shown(write_report(folder))}"]
    except DataError as error:
        return [f"no report: {error}"]
    suffix = "" if folder.name == FOLDER else f" {shlex.quote(shown(folder))}"
    return [*lines, f"to look and accept: {program()} shots review{suffix}"]
