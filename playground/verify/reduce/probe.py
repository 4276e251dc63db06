"""From a case to what came of it: written into a folder, drawn in each way that its failure asks for."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from collections.abc import Sequence
from pathlib import Path

from playground.errors import ParameterError
from playground.files import write_file
from playground.verify.reduce.candidate_process import CandidateProcess, DrawResult, DrawTask
from playground.verify.reduce.case import SHOT, Case, copied
from playground.verify.reduce.failures import Commanded, FailureKind, Finding

CANNOT_SAY = 125
"""Exit status of a command that cannot judge a candidate, as ``git bisect run`` has it."""


class Probe:
    """Tries cases against one failure."""

    def __init__(
        self, failure: FailureKind, processes: Sequence[CandidateProcess], folder: Path, limit: float
    ) -> None:
        self.failure = failure
        self.folder = folder
        self.limit = limit  # [s] of a command
        self._processes = processes
        self.refused = ""  # the error of a case that is no sketch, if there was one
        self._written: dict[str, str] = {}

    def find(self, case: Case) -> Finding | None:
        """Return how a case fails; None where it does not, or not in this way."""
        self.write(case)
        if isinstance(self.failure, Commanded):
            return self._commanded(self.failure.command)
        results: list[DrawResult] = []
        for side in self.failure.sides:
            task = task_of(case, str(self.folder / case.file), side.driver, self.failure.as_picture)
            results.append(self._processes[side.process].draw(task))
            if results[-1].kind == "refused":
                self.refused = results[-1].details
                return None
        return self.failure.finding(results)

    def renew(self) -> None:
        """End the processes, so that the next case gets new ones."""
        for process in self._processes:
            process.renew()

    def write(self, case: Case) -> None:
        """Write this case into the folder, and remove the files of the one before."""
        texts = case.texts()
        for name in self._written.keys() - texts.keys():
            (self.folder / name).unlink(missing_ok=True)
        for name, text in texts.items():
            if self._written.get(name) != text:
                write_file(self.folder / name, text)
        for name, source in copied(case.files, texts):
            if not (self.folder / name).exists():
                (self.folder / name).parent.mkdir(parents=True, exist_ok=True)
                shutil.copyfile(source, self.folder / name)
        self._written = texts

    def _commanded(self, command: str) -> Finding | None:
        """Run the user's command in the folder: status 0 is good, 125 no answer, up to 127 a failure."""
        try:
            done = subprocess.run(
                command,
                shell=True,
                cwd=self.folder,
                env={**os.environ, "PLAYGROUND_SHOT": SHOT},
                stdin=subprocess.DEVNULL,
                stdout=subprocess.DEVNULL,
                stderr=subprocess.DEVNULL,
                timeout=self.limit,
                check=False,
            )
        except subprocess.TimeoutExpired:
            return None
        status = done.returncode
        if status < 0 or status > 127:
            raise ParameterError(
                f"--command ended with status {status}: expected 0 where all is well, 1 to 127 where it"
                f" fails, {CANNOT_SAY} where it cannot say"
            )
        if sys.platform != "win32" and status in (126, 127):
            raise ParameterError(f"--command could not be run: the shell ended with status {status}")
        return (
            None if status in (0, CANNOT_SAY) else Finding("fails", f"the command ended with status {status}")
        )


def task_of(case: Case, sketch: str, driver: str, as_picture: bool = False) -> DrawTask:
    """Return the task to draw a case that is in a file."""
    names = {pass_.name for pass_ in case.live}
    steps = tuple((path, steps) for path, steps in case.steps if path in names)
    ref = "" if as_picture else "view" if case.file != "sketch.toml" else case.target
    return DrawTask(sketch=sketch, ref=ref, driver=driver, frame=case.frame, time=case.time, steps=steps)
