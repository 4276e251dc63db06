"""The trial's process as its parent sees it: handed one request at a time, killed when it must be.

A thread of its own talks to it, so that nobody waits for a process that hangs. Besides
its answers the process says when it is ready, and what it is about to do: so whoever
finds it dead knows what killed it.
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
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, Generic, TypeVar

from playground.engine.pass_time_limit import PassClock
from playground.engine.sandbox_wire import Writer
from playground.process.cpu_wait import Waits, waits_of, worked

Answer = TypeVar("Answer")

_WINDOWS = {0xC0000005: "an access violation", 0xC00000FD: "a stack overflow", 0xC0000409: "an abort"}
_CRASHES = ("SIGSEGV", "SIGBUS", "SIGILL", "SIGFPE", "SIGABRT", "SIGTRAP", *_WINDOWS.values())
_NO_MEMORY = ("out of memory", "bad_alloc", "memoryerror", "cannot allocate")


@dataclass(frozen=True)
class Ready:
    """The process has what it needs and waits for its first request."""


@dataclass(frozen=True)
class Doing:
    """What the process is about to do."""

    path: str  # of the pass; empty for a file alone
    file: str  # absolute path of its text
    driver: str = field(default="", kw_only=True)  # where one of several was asked for

    @property
    def subject(self) -> str:
        """What it is, as a sentence's subject."""
        return f"pass '{self.path}'" if self.path else "this file"


class Process(Generic[Answer]):
    """One child process, and the thread that talks to it."""

    def __init__(self, module: str, arguments: list[str]) -> None:
        self.doing: Doing | None = None  # the last thing it said of the request that it works on
        self.busy = False  # whether it was handed something and has not answered
        self.answers: queue.Queue[Answer | None] = queue.Queue()  # None: it is dead
        self.started = time.monotonic()
        self._ready_at: float | None = None
        self._handed_at = 0.0
        self._waits: Waits = {}  # when it began with what it was handed
        self._clock = PassClock(lambda: waits_of(self.pid))
        self._requests: queue.Queue[object | None] = queue.Queue()
        self._errors = tempfile.TemporaryFile()  # closed in kill
        # -P: what lies in the user's folder is no module of ours, whatever its name.
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-m", module, *arguments],
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
    def is_ready(self) -> bool:
        """Whether it has ever been ready."""
        return self._ready_at is not None

    @property
    def pid(self) -> int:
        """The process's number."""
        return self._process.pid

    @property
    def seconds(self) -> float:
        """How long it has worked on what it was handed, from when it was ready for it [s].

        What it waited for a processor does not count, but for a share.
        """
        if not self.busy or self._ready_at is None:
            return 0.0
        passed = time.monotonic() - max(self._handed_at, self._ready_at)
        return worked(passed, self._waits, waits_of(self.pid))

    @property
    def pass_seconds(self) -> float:
        """How long what it is doing has taken, of what it was handed, as ``seconds`` [s]."""
        return self._clock.seconds if self.busy and self._ready_at is not None else 0.0

    def hand_over(self, request: object) -> None:
        """Give it a request; never waits."""
        self._clock.clear()
        self.busy, self.doing, self._handed_at = True, None, time.monotonic()
        self._waits = waits_of(self.pid)
        self._requests.put(request)

    def cause_of_death(self) -> str:
        """Say how the process ended and, if it wrote anything, its last line."""
        code = None
        with contextlib.suppress(subprocess.TimeoutExpired):
            code = self._process.wait(2.0)
        self._errors.seek(0)
        said = self._errors.read().decode("utf-8", "replace").strip().split("\n")[-1].strip()
        how = "died" if not code else f"ended with status {code}"
        if code is not None and code < 0:
            how = _signal_name(-code)
        elif code in _WINDOWS:
            how = _WINDOWS[code]
        told = f"{how}; its last words: {said}" if said else how
        if any(sign in said.lower() for sign in _NO_MEMORY):
            return f"ran out of memory in the trial ({told})"
        if how in _CRASHES:
            return f"crashed the driver or its compiler in the trial ({told})"
        if how == "SIGKILL":
            return "was killed by the system in the trial (SIGKILL); did memory run out?"
        return f"ended the trial: the driver or its compiler gave up, or memory ran out ({told})"

    def ask_to_end(self) -> None:
        """Let it end by itself, if it does so soon."""
        self._requests.put(None)
        if not self.busy and self.is_ready:
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
                if receive(process.stdout) is not None:
                    self._waits = waits_of(self.pid)
                    self._ready_at = time.monotonic()
                    self._serve(process.stdin, process.stdout)
            with contextlib.suppress(OSError):
                process.stdin.close()
        self.answers.put(None)

    def _serve(self, requests: IO[bytes], answers: IO[bytes]) -> None:
        writer = Writer()
        while (request := self._requests.get()) is not None:
            self._clock.begin(None)
            send_bytes(requests, writer.write(request))
            while isinstance(answer := receive(answers), Doing):
                self._clock.begin((answer.path, answer.file, answer.driver))
                self.doing = answer
            if answer is None:
                return
            self.answers.put(answer)  # type: ignore[arg-type]


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
    send_bytes(stream, pickle.dumps(message))


def send_bytes(stream: IO[bytes], data: bytes) -> None:
    """Write one message that is bytes already."""
    stream.write(struct.pack("<Q", len(data)) + data)
    stream.flush()


def receive(stream: IO[bytes]) -> object | None:
    """Read one message of ``send``; None at the end. Only ever from our own child or parent."""
    data = receive_bytes(stream)
    return None if data is None else pickle.loads(data)


def receive_bytes(stream: IO[bytes]) -> bytes | None:
    """Read one message of ``send_bytes``; None at the end."""
    head = stream.read(8)
    if len(head) < 8:
        return None
    (length,) = struct.unpack("<Q", head)
    data = stream.read(length)
    return data if len(data) == length else None
