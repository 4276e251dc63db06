"""Try a changed sketch in a child process first, so that what kills the driver kills only the child.

A draw that hangs cannot be interrupted inside its own process, and some texts crash the
compiler. The child keeps its own headless context warm, draws one small frame, and is
killed when it takes too long or too much memory. Parent and child share the driver's
shader cache, so what the child compiled compiles at once for the parent.
"""

from __future__ import annotations

import contextlib
import os
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
        renderer = "software" if software else "any"
        self._arguments = [
            str(memory_bytes),
            renderer,
            "" if device is None else str(device),
            str(limit_seconds + 2 * _FIRST_EXTRA),
        ]
        self._child: _Child | None = None
        self._waiting: Request | None = None  # the newest, while the child still works on an older one
        self._newest = False  # whether what the child works on is the newest

    def __enter__(self) -> Trial:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    @property
    def busy(self) -> bool:
        """Whether a request waits for its answer."""
        return self._newest or self._waiting is not None

    def start(self) -> None:
        """Start the child, so that it is warm when it is needed; does nothing if it runs."""
        if self._child is None or not self._child.runs:
            self._forget()
            self._child = _Child(self._arguments)

    def run(self, request: Request) -> TrialReport:
        """Try something and wait for the answer, no longer than the limit."""
        self.submit(request)
        while (report := self._answer(wait=0.2)) is None:
            pass
        return report

    def submit(self, request: Request) -> None:
        """Hand a request to the child; an earlier one that is still open will not be answered.

        Never waits: a child that hangs reads nothing, so it is handed one request at a time.
        """
        if self._child is not None and self._child.since is not None and self._child.runs:
            self._waiting, self._newest = request, False
            return
        self._hand_over(request)

    def poll(self) -> TrialReport | None:
        """Return the answer to the newest request, once; None while there is none."""
        return self._answer(wait=0.0)

    def close(self) -> None:
        """End the child."""
        self._waiting, self._newest = None, False
        if self._child is not None:
            self._child.ask_to_end()
        self._forget()

    def _hand_over(self, request: Request) -> None:
        self.start()
        assert self._child is not None
        self._waiting, self._newest = None, True
        self._child.hand_over(request)

    def _answer(self, wait: float) -> TrialReport | None:
        child = self._child
        if child is None or child.since is None:
            return None
        limit = self.limit_seconds + (0.0 if child.is_warm else _FIRST_EXTRA)
        try:
            report = child.answers.get(timeout=wait) if wait else child.answers.get_nowait()
        except queue.Empty:
            if time.monotonic() - child.since < limit:
                return None
            self._forget()
            message = f"the trial took longer than {limit:g} s and was stopped; is there an endless loop?"
            return self._told(TrialReport(False, TrialTimeout(message), seconds=limit))
        if report is None:
            spent, cause = time.monotonic() - child.since, child.cause_of_death()
            self._forget()
            return self._told(TrialReport(False, TrialCrash(cause), seconds=spent))
        child.since, child.is_warm = None, True
        return self._told(report)

    def _told(self, report: TrialReport) -> TrialReport | None:
        """Return an answer if it is the newest request's; else hand over the one that waits."""
        if self._newest:
            self._newest = False
            return report
        if self._waiting is not None:
            self._hand_over(self._waiting)
        return None

    def _forget(self) -> None:
        child, self._child = self._child, None
        if child is not None:
            child.kill()


class _Child:
    """The process, and the thread that talks to it."""

    def __init__(self, arguments: list[str]) -> None:
        self.since: float | None = None  # when it was handed what it works on
        self.is_warm = False  # it has answered before
        self.answers: queue.Queue[TrialReport | None] = queue.Queue()  # None: it is dead
        self._requests: queue.Queue[Request | None] = queue.Queue()
        self._errors = tempfile.TemporaryFile()  # closed in kill
        # -P: what lies in the user's folder is no module of ours, whatever its name.
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", "playground.engine.trial_child", *arguments],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=self._errors,
            env=_environment(),
            start_new_session=True,
        )
        self._thread = threading.Thread(target=self._talk, daemon=True)
        self._thread.start()

    @property
    def runs(self) -> bool:
        """Whether the process lives."""
        return self._process.poll() is None

    @property
    def pid(self) -> int:
        """The process's number."""
        return self._process.pid

    def hand_over(self, request: Request) -> None:
        """Give it a request; never waits."""
        self.since = time.monotonic()
        self._requests.put(request)

    def cause_of_death(self) -> str:
        """Say how the process ended, with the last line that it wrote."""
        code = None
        with contextlib.suppress(subprocess.TimeoutExpired):
            code = self._process.wait(2.0)
        self._errors.seek(0)
        said = self._errors.read().decode("utf-8", "replace").strip().split("\n")[-1].strip()
        how = "died"
        if code is not None and code < 0:
            how = f"was killed by {_signal_name(-code)}"
        elif code:
            how = f"ended with status {code}"
        told = f" ({said})" if said else ""
        return f"the trial {how}: the driver or its compiler crashed, or memory ran out{told}"

    def ask_to_end(self) -> None:
        """Let it end by itself, if it does so soon."""
        self._requests.put(None)
        if self.since is None and self.is_warm:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(1.0)

    def kill(self) -> None:
        """End it whatever it does."""
        self._process.kill()
        self._requests.put(None)
        with contextlib.suppress(subprocess.TimeoutExpired):
            self._process.wait(5.0)
        self._thread.join(5.0)
        self._errors.close()

    def _talk(self) -> None:
        process = self._process
        assert process.stdin is not None and process.stdout is not None
        # Its pipes are closed here, where they are used: closing waits for whoever reads.
        with contextlib.suppress(OSError), process.stdout:
            with contextlib.suppress(OSError, EOFError, ValueError, pickle.UnpicklingError):
                while (request := self._requests.get()) is not None:
                    send(process.stdin, request)
                    answer = receive(process.stdout)
                    if answer is None:
                        break
                    self.answers.put(answer)  # type: ignore[arg-type]
            with contextlib.suppress(OSError):
                process.stdin.close()
        self.answers.put(None)


def _environment() -> dict[str, str]:
    """Return an environment in which the child finds this package, wherever it was started."""
    package = str(Path(__file__).resolve().parents[2])
    known = [p for p in os.environ.get("PYTHONPATH", "").split(os.pathsep) if p]
    return {**os.environ, "PYTHONPATH": os.pathsep.join([package, *known])}


def _signal_name(number: int) -> str:
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


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
