"""Try a changed sketch in a child process first, so that what kills the driver kills only the child.

A draw that hangs cannot be interrupted inside its own process, and some texts crash the
compiler. The child keeps its own headless context warm, draws one small frame, and is
killed when it takes too long or too much memory. Parent and child share the driver's
shader cache, so what the child compiled compiles at once for the parent.
"""

from __future__ import annotations

import contextlib
import pickle
import queue
import signal
import struct
import subprocess
import sys
import tempfile
import threading
import time
from dataclasses import dataclass
from pathlib import Path
from types import TracebackType
from typing import IO

from playground.errors import PlaygroundError, TrialCrash, TrialTimeout
from playground.sketch.model import Sketch

LIMIT_SECONDS = 10.0
LIMIT_BYTES = 4 * 2**30
_FIRST_EXTRA = 20.0  # [s] more for the first answer of a child: it starts Python and opens a context


@dataclass(frozen=True)
class TrySketch:
    """Draw one small frame of a sketch, by each driver named."""

    sketch: Sketch
    size: tuple[int, int] = (64, 36)  # pixels
    time: float = 0.0  # [s]
    drivers: tuple[str, ...] = ("auto",)


@dataclass(frozen=True)
class TryLibrary:
    """Compile a library file alone, as a fragment and as a compute shader."""

    path: str
    folder: str


Request = TrySketch | TryLibrary


@dataclass(frozen=True)
class TrialReport:
    """How a trial ended."""

    ok: bool
    error: PlaygroundError | None = None
    skipped: tuple[str, ...] = ()  # what could not be tried here, as "compute"
    seconds: float = 0.0


class Trial:
    """A warm child process that tries sketches.

    Use it with ``with``, or call ``close()``. ``run`` waits for an answer; ``submit`` and
    ``poll`` do not, and only the newest request is answered.
    """

    def __init__(
        self,
        *,
        limit_seconds: float = LIMIT_SECONDS,
        memory_bytes: int = LIMIT_BYTES,
        software: bool = False,
        device: int | None = None,
    ) -> None:
        self.limit_seconds = limit_seconds
        self.memory_bytes = memory_bytes
        self._arguments = [str(memory_bytes), "software" if software else "any", "" if device is None else str(device)]
        self._process: subprocess.Popen[bytes] | None = None
        self._answers: queue.Queue[tuple[int, TrialReport] | None] = queue.Queue()
        self._errors: IO[bytes] | None = None
        self._number = 0  # of the newest request
        self._since: float | None = None  # when it was handed over
        self._fresh = True  # the child has not answered yet

    def __enter__(self) -> Trial:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def busy(self) -> bool:
        """Whether a request waits for its answer."""
        return self._since is not None

    def start(self) -> None:
        """Start the child, so that it is warm when it is needed; does nothing if it runs."""
        if self._process is not None and self._process.poll() is None:
            return
        self._forget()
        self._errors = tempfile.TemporaryFile()  # noqa: SIM115 - closed in _forget
        self._process = subprocess.Popen(
            [sys.executable, "-m", "playground.engine.trial_child", *self._arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            start_new_session=True,
        )
        self._answers = queue.Queue()
        self._fresh = True
        threading.Thread(target=_listen, args=(self._process.stdout, self._answers), daemon=True).start()

    def run(self, request: Request) -> TrialReport:
        """Try something and wait for the answer, no longer than the limit."""
        self.submit(request)
        while (report := self._answer(wait=0.2)) is None:
            pass
        return report

    def submit(self, request: Request) -> None:
        """Hand a request to the child; an earlier one that is still open will not be answered."""
        self.start()
        self._number += 1
        self._since = time.monotonic()
        process = self._process
        assert process is not None and process.stdin is not None
        with contextlib.suppress(OSError):  # a child that died is found out by poll
            send(process.stdin, (self._number, request))

    def poll(self) -> TrialReport | None:
        """Return the answer to the newest request, once; None while there is none."""
        return self._answer(wait=0.0)

    def close(self) -> None:
        """End the child."""
        if self._process is not None and self._process.poll() is None:
            with contextlib.suppress(OSError):
                self._process.stdin.close()  # type: ignore[union-attr]
            try:
                self._process.wait(0.5)
            except subprocess.TimeoutExpired:
                self._process.kill()
        self._forget()

    def _answer(self, wait: float) -> TrialReport | None:
        if self._since is None:
            return None
        limit = self.limit_seconds + (_FIRST_EXTRA if self._fresh else 0.0)
        try:
            found = self._answers.get(timeout=wait) if wait else self._answers.get_nowait()
        except queue.Empty:
            if time.monotonic() - self._since < limit:
                return None
            self._kill()
            message = f"the trial took longer than {limit:g} s and was stopped; is there an endless loop?"
            return self._done(TrialReport(False, TrialTimeout(message), seconds=limit))
        if found is None:
            return self._done(TrialReport(False, TrialCrash(self._cause()), seconds=time.monotonic() - self._since))
        self._fresh = False
        number, report = found
        if number != self._number:
            self._since = time.monotonic()  # the child only now begins with the newest
            return None
        return self._done(report)

    def _done(self, report: TrialReport) -> TrialReport:
        self._since = None
        return report

    def _cause(self) -> str:
        process, code = self._process, None
        if process is not None:
            with contextlib.suppress(subprocess.TimeoutExpired):
                code = process.wait(2.0)
        said = ""
        if self._errors is not None:
            self._errors.seek(0)
            lines = self._errors.read().decode("utf-8", "replace").strip().split("\n")
            said = lines[-1].strip()
        self._forget()
        how = "died"
        if code is not None and code < 0:
            how = f"was killed by {signal.Signals(-code).name}"
        elif code:
            how = f"ended with status {code}"
        return f"the trial {how}: the driver or its compiler crashed, or memory ran out" + (f" ({said})" if said else "")

    def _kill(self) -> None:
        if self._process is not None:
            self._process.kill()
        self._forget()

    def _forget(self) -> None:
        process, self._process = self._process, None
        if process is not None:
            for pipe in (process.stdin, process.stdout):
                if pipe is not None:
                    with contextlib.suppress(OSError):
                        pipe.close()
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(2.0)
        if self._errors is not None:
            self._errors.close()
            self._errors = None


def send(stream: IO[bytes], message: object) -> None:
    """Write one message, its length before it."""
    data = pickle.dumps(message)
    stream.write(struct.pack("<Q", len(data)) + data)
    stream.flush()


def receive(stream: IO[bytes]) -> object | None:
    """Read one message of ``send``; None at the end. Only ever from our own child or parent."""
    head = stream.read(8)
    if len(head) < 8:
        return None
    (length,) = struct.unpack("<Q", head)
    data = stream.read(length)
    return pickle.loads(data) if len(data) == length else None


def _listen(stream: IO[bytes], answers: queue.Queue[tuple[int, TrialReport] | None]) -> None:
    with contextlib.suppress(OSError, ValueError, pickle.UnpicklingError):
        while (message := receive(stream)) is not None:
            answers.put(message)  # type: ignore[arg-type]
    answers.put(None)


def folder_of(path: str | Path) -> str:
    """Return the folder that a file alone may include from."""
    return str(Path(path).resolve().parent)
