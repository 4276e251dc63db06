"""Leave a record of each checked shot in the results folder of this run of pytest."""

from __future__ import annotations

import os
import shlex
import time
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray

from playground.errors import DataError
from playground.paths import shown
from playground.shots.compare import difference_picture
from playground.shots.flip import flip_picture
from playground.shots.judge import OTHER_BUILD, OTHER_RENDERER, SAME_BUILD, STRUCTURE_ONLY
from playground.shots.names import CHECKED, LOOSE
from playground.shots.references import accepted, home_of, reference_texts
from playground.shots.report import write_report
from playground.shots.results import FOLDER, PICTURES, Record, digests_of, write_result
from playground.shots.suite import Outcome, ShotCase

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
        self._run = os.environ.get("PYTEST_XDIST_TESTRUNUID") or os.urandom(16).hex()

    def record(self, node: pytest.Item, outcome: Outcome, seconds: float, command: str) -> None:
        """Leave the record of a picture that was compared, with the pictures unless it passed."""
        found, seen, reference = outcome.comparison, outcome.judgement.seen, outcome.reference
        name, own = outcome.case.shot.name, outcome.renderer.slug
        record = self._begun(node, outcome.case, outcome.word, outcome.sentence, seconds)
        record = replace(
            record,
            renderer=own,
            tier=outcome.tier,
            catches=_CATCHES.get(outcome.tier, ""),
            size=found.size,
            expected_size=found.expected_size,
            place=seen.place if seen else found.place,
            numbers=_numbers(outcome),
            texts=reference_texts(outcome.fingerprint, outcome.case.sketch.name, name),
            expected_texts=reference.text if reference else {},
            fingerprint=outcome.differences,
            compared=reference.path.name if reference else "",
            references=digests_of(accepted(outcome.case.sketch, name, own)),
            command=command,
        )
        self._write(node, record, {} if outcome.ok else _pictures(outcome))
        if outcome.tier == OTHER_RENDERER:
            node.user_properties.append((LOOSE, own))

    def record_none(
        self, node: pytest.Item, case: ShotCase, word: str, sentence: str, seconds: float
    ) -> None:
        """Leave the record of a shot of which there is no picture."""
        first, _, rest = sentence.partition("\n")
        record = self._begun(node, case, word, first, seconds)
        self._write(node, replace(record, error=rest), {})

    def pictures(self, case: ShotCase) -> Iterator[tuple[str, Path]]:
        """Yield word and file of each picture that a failed shot has left."""
        for word in PICTURES:
            path = self.folder / case.sketch.name / f"{case.shot.name}.{word}.png"
            if path.exists():
                yield word, path

    def _write(self, node: pytest.Item, record: Record, pictures: dict[str, NDArray[np.uint8]]) -> None:
        write_result(self.folder, record, pictures)
        node.user_properties.append((CHECKED, record.word))

    def _begun(self, node: pytest.Item, case: ShotCase, word: str, sentence: str, seconds: float) -> Record:
        return Record(
            case.sketch.name,
            case.shot.name,
            word,
            sentence,
            root=str(self.root),
            home=_home(case, self.root),
            node=node.nodeid,
            seconds=seconds,
            when=time.time(),
            run=self._run,
        )


def _home(case: ShotCase, root: Path) -> str:
    try:
        home = home_of(case.sketch)
    except DataError:
        return ""
    return home.relative_to(root).as_posix() if home.is_relative_to(root) else str(home)


def _numbers(outcome: Outcome) -> dict[str, float]:
    found, judgement = outcome.comparison, outcome.judgement
    if found.verdict in ("blank", "missing", "size"):
        return {}
    numbers: dict[str, float] = {
        "largest difference, levels of 255": found.most,
        f"pixels over {found.tolerance}": found.over,
        f"pixels over {found.tolerance}, %": 100.0 * found.over / (found.size[0] * found.size[1]),
    }
    if judgement.crowd is not None:
        numbers["pixels in the most crowded window"] = judgement.crowd.count
    if judgement.seen is not None:
        numbers |= {"FLIP, mean": judgement.seen.mean, "FLIP, worst tile": judgement.seen.tile}
    return numbers


def _pictures(outcome: Outcome) -> dict[str, NDArray[np.uint8]]:
    actual, reference = outcome.frame.array, outcome.reference
    if reference is None:
        return {"actual": actual}
    pictures = {"actual": actual, "expected": reference.pixels}
    pictures["difference"] = difference_picture(actual, reference.pixels)
    if actual.shape == reference.pixels.shape:
        pictures["flip"] = flip_picture(actual, reference.pixels)
    return pictures


def report(folder: Path) -> list[str]:
    """Write the report on a folder of results, and say where it is and how to look at it."""
    try:
        lines = [f"report: {shown(write_report(folder))}"]
    except DataError as error:
        return [f"no report: {error}"]
    given = "" if folder.name == FOLDER else f" {shlex.quote(shown(folder))}"
    return [*lines, f"to look and accept: playground shots review{given}"]
